"""`darkflat store certify`: a verified set holds from now on."""

from datetime import datetime
from typing import Annotated

import typer

from service.cli.answering import Json, answering
from service.cli.shared_options import By


def certify(
    set_id: Annotated[str, typer.Argument(metavar="ID", help="Or its first 8 digits or more")],
    *,
    valid_from: Annotated[datetime, typer.Option("--from", help="UTC")],
    valid_until: Annotated[
        datetime | None, typer.Option("--until", help="UTC, excluded; open where not given")
    ] = None,
    reason: Annotated[str, typer.Option(help="Why, for those who read the record later")],
    supersedes: Annotated[
        list[str] | None, typer.Option(help="A set that holds up to then; may be repeated")
    ] = None,
    by: By = None,
    json: Json = None,
) -> None:
    """Certify a verified set for a time."""
    with answering(json) as answer:
        from service.cli.opened_store import opened_store, who  # noqa: PLC0415
        from service.cli.set_record import show_record, told, utc  # noqa: PLC0415
        from service.store.actor import Actor  # noqa: PLC0415

        with opened_store() as store:
            record = store.sets.certify(
                set_id,
                valid_from=utc(valid_from) or valid_from,
                valid_until=utc(valid_until),
                by=Actor(by or who()),
                reason=reason,
                supersedes=supersedes or (),
            )
        answer.give(told(record), show_record(record))
