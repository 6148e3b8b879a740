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
        from service.cli.opened_store import opened_store, who  # noqa: PLC0415
        from service.cli.set_record import show_record, told  # noqa: PLC0415
        from service.store.actor import Actor  # noqa: PLC0415

        with opened_store() as store:
            record = store.sets.verify(set_id, by=Actor(by or who()), reason=reason)
        answer.give(told(record), show_record(record))
