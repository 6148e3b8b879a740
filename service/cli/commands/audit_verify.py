"""`darkflat audit verify`: nothing was changed."""

from typing import Annotated

import typer

from service.cli.answering import Json, answering


def verify(
    expect: Annotated[
        str | None,
        typer.Option(
            metavar="DIGEST",
            help="Of the last entry, as printed earlier: proves that the end was not cut off",
        ),
    ] = None,
    json: Json = None,
) -> None:
    """Prove that the log is whole; print how many entries it has, and the last one's digest."""
    with answering(json) as answer:
        from service.cli.opened_store import opened_store  # noqa: PLC0415
        from service.cli.tables import facts  # noqa: PLC0415

        with opened_store() as store:
            number, digest = store.audit.verify(expect=expect)
        answer.give(
            {"entries": number, "digest": digest},
            lambda console: facts(console, {"entries": str(number), "last digest": digest}),
        )
