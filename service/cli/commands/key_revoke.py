"""`darkflat key revoke`: a key opens nothing any more."""

from typing import Annotated

import typer

from service.cli.answering import Json, answering
from service.cli.shared_options import By


def revoke(
    key_id: Annotated[str, typer.Argument(metavar="ID", help="As `key list` shows it")],
    by: By = None,
    json: Json = None,
) -> None:
    """End a key at once, for a running service too."""
    with answering(json) as answer:
        from service.cli.key_record import show_keys, told  # noqa: PLC0415
        from service.cli.opened_store import opened_store, who  # noqa: PLC0415
        from service.store.actor import Actor  # noqa: PLC0415

        with opened_store() as store:
            record = store.keys.revoke(key_id, by=Actor(by or who()))
        answer.give(told(record), show_keys([record]))
