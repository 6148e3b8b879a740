"""`darkflat store lookup`: which set is in force."""

from datetime import UTC, datetime
from typing import Annotated

import typer

from service.cli.answering import Json, answering


def lookup(
    *,
    serial: Annotated[str, typer.Option(help="Of the camera")],
    band: Annotated[str, typer.Option()] = "",
    gain_db: Annotated[float, typer.Option("--gain", help="Of the camera, dB")] = 0.0,
    bit_depth: Annotated[int, typer.Option(min=8, max=16)],
    region: Annotated[
        str | None, typer.Option(help="Columns read out, such as 0:6144; where there are several")
    ] = None,
    at: Annotated[datetime | None, typer.Option(help="UTC; now where not given")] = None,
    json: Json = None,
) -> None:
    """Find the coefficient set that is in force for a camera setting at a time."""
    with answering(json) as answer:
        from service.cli.opened_store import opened_store  # noqa: PLC0415
        from service.cli.set_record import show_record, told, utc  # noqa: PLC0415

        with opened_store() as store:
            record = store.sets.lookup(
                serial=serial,
                band=band,
                gain_db=gain_db,
                bit_depth=bit_depth,
                region=region,
                at=utc(at) or datetime.now(UTC),
            )
            path = store.sets.files.path(record.id)
        answer.give({**told(record), "path": path}, show_record(record))
