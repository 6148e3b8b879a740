"""`darkflat store show`: one coefficient set and its life."""

from typing import Annotated

import typer

from service.cli.answering import Json, answering


def show(
    set_id: Annotated[str, typer.Argument(metavar="ID", help="Or its first 8 digits or more")],
    json: Json = None,
) -> None:
    """Show one coefficient set and its life."""
    with answering(json) as answer:
        from service.cli.opened_store import opened_store  # noqa: PLC0415
        from service.cli.set_record import show_record, told  # noqa: PLC0415

        with opened_store() as store:
            record = store.sets.get(set_id)
            path = store.sets.files.path(record.id)
        answer.give({**told(record), "path": path}, show_record(record))
