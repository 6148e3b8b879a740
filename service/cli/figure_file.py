"""Writing a figure where the caller wants it."""

import io
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from calib.errors import InputError
from calib.recording.durable import refuse_existing, write_whole

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_FORMATS = ("svg", "png", "pdf")


def check_figure(path: Path | None) -> None:
    """Raise InputError `figure-format` or `output-exists` before any work is done."""
    if path is None:
        return
    if path.suffix.lower().lstrip(".") not in _FORMATS:
        msg = f"{path} does not say a format for a figure: end its name in .svg, .png or .pdf"
        raise InputError(msg, code="figure-format")
    refuse_existing(path)


def write_figure(path: Path, draw: Callable[[], "Figure"]) -> None:
    """Draw in the house's style and write to `path`, whole or not at all."""
    from calib.report.style import house_style  # noqa: PLC0415  (matplotlib is slow)

    made = io.BytesIO()
    with house_style():
        draw().savefig(made, format=path.suffix.lower().lstrip("."))
    write_whole(path, made.getvalue())
