"""`darkflat store list`: what the store has."""

from enum import StrEnum
from typing import Annotated

import typer

from service.cli.answering import Json, answering
from service.cli.shared_options import Before, Limit


class State(StrEnum):
    """Those of `service.store.state`, which is not imported for the sake of `--help`."""

    DRAFT = "draft"
    VERIFIED = "verified"
    CERTIFIED = "certified"
    SUPERSEDED = "superseded"
    REVOKED = "revoked"


def list_sets(
    *,
    state: Annotated[State | None, typer.Option()] = None,
    serial: Annotated[str | None, typer.Option(help="Of the camera")] = None,
    band: Annotated[str | None, typer.Option()] = None,
    limit: Limit = 100,
    before: Before = None,
    json: Json = None,
) -> None:
    """List coefficient sets, newest first."""
    with answering(json) as answer:
        from service.cli.opened_store import opened_store  # noqa: PLC0415
        from service.cli.set_record import show_records, told  # noqa: PLC0415
        from service.store.state import SetState  # noqa: PLC0415

        with opened_store() as store:
            page = store.sets.list(
                state=SetState(state.value) if state else None,
                serial=serial,
                band=band,
                limit=limit,
                before=before,
            )
        content = {"items": [told(each) for each in page.items], "next_before": page.next_before}
        answer.give(content, show_records(page.items))
