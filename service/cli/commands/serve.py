"""`darkflat serve`: the service."""

import os
from contextlib import closing
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from service.cli.answering import Answer, Json, answering
from service.cli.for_good import for_good
from service.cli.paths import path_option

if TYPE_CHECKING:
    from service.owner.owner import BenchOwner
    from service.settings import Settings


class LogLines(StrEnum):
    """For people, or for programs."""

    TEXT = "text"
    JSON = "json"


def serve(
    *,
    host: Annotated[str | None, typer.Option(help="127.0.0.1 where not given")] = None,
    port: Annotated[int | None, typer.Option(min=0, max=65535, help="0: any that is free")] = None,
    bench: Annotated[Path | None, path_option(metavar="bench.toml")] = None,
    log: Annotated[LogLines | None, typer.Option(help="The form of the log's lines")] = None,
    json: Json = None,
) -> None:
    """Serve the bench, its recordings and coefficient sets over HTTP; without one, a simulated."""
    with answering(json) as answer:
        from service.cli.simulated_bench import chosen_bench  # noqa: PLC0415
        from service.owner.owner import BenchOwner  # noqa: PLC0415
        from service.settings import Settings  # noqa: PLC0415
        from service.watching.log import ENVIRONMENT  # noqa: PLC0415

        loaded = Settings.load()
        given = {"host": host, "port": port, "bench": bench, "log": log and log.value}
        settings = loaded.model_copy(update={k: v for k, v in given.items() if v is not None})
        chosen = chosen_bench(settings.bench)
        os.environ[ENVIRONMENT] = settings.log  # what is started logs alike
        with closing(BenchOwner(chosen.settings)) as owner:
            owner.open()  # before all that takes long: lamps may burn that a dead service lit
            _serve(settings, owner, answer)


def _serve(settings: "Settings", owner: "BenchOwner", answer: Answer) -> None:
    with for_good():
        from service.app import create_app  # noqa: PLC0415
        from service.cli.listening import listen, serve_until_stopped  # noqa: PLC0415
        from service.store.store import Store  # noqa: PLC0415

    with Store.open(settings) as store:
        has_keys = store.keys.any()
    with listen(settings.host, settings.port, has_keys=has_keys) as listening:
        with for_good():
            app = create_app(settings, owner=owner, page=True)
        url = f"http://{settings.host}:{listening.getsockname()[1]}"
        answer.give(
            {
                "url": url,
                "page": f"{url}/page/",
                "docs": f"{url}/docs",
                "home": settings.home,
                "bench": owner.bench_id,
            },
            lambda console: console.print(f"{url}   (Ctrl-C ends it)", markup=False),
        )
        serve_until_stopped(app, listening, settings.log)
