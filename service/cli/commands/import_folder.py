"""`darkflat import`: a recording made elsewhere comes in."""

from pathlib import Path
from typing import Annotated

from service.cli.answering import Json, answering
from service.cli.paths import path_argument, path_option
from service.cli.progress import progress, share_of


def import_folder(
    folder: Annotated[Path, path_argument(help="recording.toml, conditions.csv and frames/")],
    out: Annotated[Path, path_option(help="The recording to write, .h5")],
    json: Json = None,
) -> None:
    """Turn a recording folder into a recording file."""
    with answering(json) as answer:
        from calib.recording.folder import import_folder as import_it  # noqa: PLC0415
        from calib.recording.folder_recording import FolderRecording  # noqa: PLC0415
        from service.cli.recording_summary import show, summary  # noqa: PLC0415

        odd = FolderRecording(folder).warnings
        with progress("Importing") as report:
            recording = import_it(folder, out, progress=share_of(report))
        told = {**summary(recording), "warnings": list(odd)}
        answer.give(told, show(told))
