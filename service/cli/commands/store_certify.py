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
        from service.cli.set_record import utc  # noqa: PLC0415
        from service.cli.set_step import take_step  # noqa: PLC0415

        take_step(
            answer,
            by,
            lambda sets, actor: sets.certify(
                set_id,
                valid_from=utc(valid_from) or valid_from,
                valid_until=utc(valid_until),
                by=actor,
                reason=reason,
                supersedes=supersedes or (),
            ),
        )
