"""`darkflat store add-recording`: make a recording known, to the service too."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from service.cli.answering import Json, answering
from service.cli.paths import path_argument
from service.cli.shared_options import By

if TYPE_CHECKING:
    from rich.console import Console

    from service.store.records import RecordingRecord


def add_recording(
    recording: Annotated[Path, path_argument(metavar="REC", help="An .h5 or a recording folder")],
    by: By = None,
    json: Json = None,
) -> None:
    """Make a recording known by its digest; its file stays where it is and is not copied."""
    with answering(json) as answer:
        from dataclasses import asdict  # noqa: PLC0415

        from calib.recording.open import open_recording  # noqa: PLC0415
        from service.cli.known_recording import make_known  # noqa: PLC0415
        from service.cli.opened_store import opened_store, who  # noqa: PLC0415

        opened = open_recording(recording)
        with opened_store() as store:
            record = make_known(store, opened, by=by or who())
        answer.give(asdict(record), lambda console: _show(console, record))


def _show(console: "Console", record: "RecordingRecord") -> None:
    from service.cli.tables import facts  # noqa: PLC0415

    facts(
        console,
        {
            "recording": record.digest,
            "name": record.name,
            "camera": f"{record.camera_serial or '–'}, band {record.band or '–'}",
            "file": record.path,
        },
    )
