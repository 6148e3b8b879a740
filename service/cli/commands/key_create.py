"""`darkflat key create`: a new key, told once."""

from datetime import UTC, datetime, timedelta
from enum import StrEnum
from typing import Annotated

import typer

from service.cli.answering import Json, answering
from service.cli.duration import parse_duration
from service.cli.shared_options import By


class Scope(StrEnum):
    """Those of `service.store.keys`, which is not imported for the sake of `--help`."""

    READ = "read"
    OPERATE = "operate"
    CERTIFY = "certify"
    ADMIN = "admin"


def create(
    name: Annotated[str, typer.Argument(help="Who or what uses it")],
    *,
    scope: Annotated[Scope, typer.Option(help="Each includes those before it")] = Scope.READ,
    expires: Annotated[
        timedelta | None,
        typer.Option(
            parser=parse_duration, metavar="TIME", help="After 12h, 90d, 52w; never where not given"
        ),
    ] = None,
    by: By = None,
    json: Json = None,
) -> None:
    """Make a key. It is shown once: only its digest is kept."""
    with answering(json) as answer:
        from service.cli.key_record import told  # noqa: PLC0415
        from service.cli.opened_store import opened_store, who  # noqa: PLC0415
        from service.store import keys  # noqa: PLC0415
        from service.store.actor import Actor  # noqa: PLC0415

        with opened_store() as store:
            record, secret = store.keys.create(
                name,
                keys.Scope(scope.value),
                expires_at=None if expires is None else datetime.now(UTC) + expires,
                by=Actor(by or who()),
            )
        answer.give(
            {**told(record), "key": secret},
            lambda console: console.print(secret, markup=False, highlight=False, soft_wrap=True),
        )
