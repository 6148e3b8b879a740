"""Puts the data sheet on one page that needs nothing but itself."""

from collections.abc import Iterator
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path

from jinja2 import Environment, StrictUndefined
from markupsafe import Markup
from matplotlib.figure import Figure

from calib.recording.durable import write_whole
from calib.report.camera_words import camera_name
from calib.report.style import as_svg, house_style
from calib.transfer.emva1288.report import spatial, temporal, words
from calib.transfer.emva1288.sheet import METHOD, DataSheet

CAPTIONS = {
    "photon-transfer": "Shot noise makes a straight line through the origin; its slope is the "
    "system gain. A residual that bends is no shot noise.",
    "sensitivity": "What the camera makes of light.",
    "signal-to-noise": "Points are single flats. Fixed patterns are in the total alone: they do "
    "not average out from frame to frame.",
    "linearity": "The line leaves the least relative deviation. Its offset is part of it.",
    "dark-current": "Both slopes are the same electrons; the variance shows them even where the "
    "camera takes the mean off.",
    "dark-current-doubling": "Against the sensor's temperature.",
    "dsnu-spectrograms": "Lines above the noise are regular patterns.",
    "prnu-spectrograms": "The rise at the left is uneven light.",
    "dsnu-profiles": "The averaged dark image.",
    "prnu-profiles": "The averaged flat less its dark, relative to its mean, with uneven light.",
    "defects": "Dashed: a normal distribution of the same spread. Pixels outside it are the "
    "candidates for a defect list; PRNU behind the highpass.",
}  # fmt: skip


@dataclass(frozen=True)
class SheetFigure:
    """A figure and its name (a file's, in the gallery)."""

    name: str
    figure: Figure


@dataclass(frozen=True)
class Picture:
    """An inline SVG and what to see in it."""

    svg: Markup
    caption: str


def figures(sheet: DataSheet) -> tuple[SheetFigure, ...]:
    """Draw every figure that the sheet has the points for, in the page's order."""
    return tuple(SheetFigure(name, drawn) for name, drawn in _drawn(sheet) if drawn is not None)


def _drawn(sheet: DataSheet) -> Iterator[tuple[str, Figure | None]]:
    yield "photon-transfer", temporal.photon_transfer(sheet)
    yield "sensitivity", temporal.sensitivity(sheet)
    if sheet["system_gain_dn_per_e"].is_known:
        yield "signal-to-noise", temporal.signal_to_noise(sheet)
    yield "linearity", temporal.linearity(sheet)
    yield "dark-current", temporal.dark_current(sheet)
    yield "dark-current-doubling", temporal.doubling(sheet)
    if sheet.spatial is not None:
        yield "dsnu-spectrograms", spatial.spectrograms(sheet.spatial.dark)
        yield "prnu-spectrograms", spatial.spectrograms(sheet.spatial.flat)
        yield "dsnu-profiles", spatial.profiles(sheet.spatial.dark)
        yield "prnu-profiles", spatial.profiles(sheet.spatial.flat)
    yield "defects", spatial.defects(sheet)


def write_page(path: Path, sheet: DataSheet) -> None:
    """Write the data sheet to `path`, whole or not at all."""
    with house_style():
        # Our own drawing, not text from outside: it may stand unescaped.
        pictures = tuple(
            Picture(Markup(as_svg(drawn.figure)), CAPTIONS[drawn.name])  # noqa: S704
            for drawn in figures(sheet)
        )
    text = files("calib.transfer.emva1288.report").joinpath("page.html.j2").read_text("utf-8")
    template = Environment(autoescape=True, undefined=StrictUndefined).from_string(text)
    page = template.render(
        title=f"EMVA 1288 data sheet of {camera_name(sheet.header.camera)}",
        method=METHOD,
        conditions=words.conditions(sheet),
        warnings=sheet.warnings,
        photon_scale=words.photon_scale(sheet),
        sections=words.sections(sheet),
        pictures=pictures,
    )
    write_whole(path, page.encode())
