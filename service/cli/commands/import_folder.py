"""`darkflat import`: a recording made elsewhere comes in."""

from pathlib import Path
from typing import Annotated

import typer

from service.cli.answering import Json, answering
from service.cli.progress import progress, share_of


def import_folder(
    folder: Annotated[Path, typer.Argument(help="recording.toml, conditions.csv and frames/")],
    out: Annotated[Path, typer.Option(help="The recording to write, .h5")],
    json: Json = None,
) -> None:
    """Turn a recording folder into a recording file."""
    with answering(json) as answer:
        from calib.recording.folder import import_folder as import_it  # noqa: PLC0415
        from service.cli.recording_summary import show, summary  # noqa: PLC0415

        with progress("Importing") as report:
            recording = import_it(folder, out, progress=share_of(report))
        told = summary(recording)
        answer.give(told, show(told))
