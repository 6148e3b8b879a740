"""`darkflat export`: a recording as a folder that other programs read."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from service.cli.answering import Json, answering
from service.cli.paths import path_argument, path_option
from service.cli.progress import progress, share_of


class FrameFormat(StrEnum):
    """How frames are stored."""

    NPY = "npy"
    TIF = "tif"
    FITS = "fits"
    RAW = "raw"


def export(
    recording: Annotated[Path, path_argument(metavar="REC", help="An .h5 or a recording folder")],
    out: Annotated[Path, path_option(help="The folder to make")],
    frame_format: Annotated[
        FrameFormat, typer.Option("--format", help="Of the frames")
    ] = FrameFormat.NPY,
    json: Json = None,
) -> None:
    """Turn a recording into a recording folder."""
    with answering(json) as answer:
        from calib.recording.folder import export_folder  # noqa: PLC0415
        from calib.recording.open import open_recording  # noqa: PLC0415
        from service.cli.recording_summary import show, summary  # noqa: PLC0415

        with progress("Exporting") as report:
            exported = export_folder(
                open_recording(recording),
                out,
                frame_format=frame_format.value,
                progress=share_of(report),
            )
        told = summary(exported)
        answer.give(told, show(told))
