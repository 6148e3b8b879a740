"""`darkflat store revoke`: a set was wrong."""

from typing import Annotated

import typer

from service.cli.answering import Json, answering
from service.cli.shared_options import By


def revoke(
    set_id: Annotated[str, typer.Argument(metavar="ID", help="Or its first 8 digits or more")],
    reason: Annotated[str, typer.Option(help="Why, for those who read the record later")],
    by: By = None,
    json: Json = None,
) -> None:
    """Say that a certified set was wrong: it holds for no time any more."""
    with answering(json) as answer:
        from service.cli.set_step import take_step  # noqa: PLC0415

        take_step(answer, by, lambda sets, actor: sets.revoke(set_id, by=actor, reason=reason))
