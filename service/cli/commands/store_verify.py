"""`darkflat store verify`: somebody looked at a draft."""

from typing import Annotated

import typer

from service.cli.answering import Json, answering
from service.cli.shared_options import By


def verify(
    set_id: Annotated[str, typer.Argument(metavar="ID", help="Or its first 8 digits or more")],
    reason: Annotated[str, typer.Option(help="What was looked at")] = "",
    by: By = None,
    json: Json = None,
) -> None:
    """Say that a draft was looked at; its file is checked against its id."""
    with answering(json) as answer:
        from service.cli.set_step import take_step  # noqa: PLC0415

        take_step(answer, by, lambda sets, actor: sets.verify(set_id, by=actor, reason=reason))
