import gc
import socket
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import pytest
import uvicorn
from fastapi import FastAPI

from service.cli.answering import Answer
from service.cli.commands.serve import _serve
from service.cli.for_good import for_good
from service.settings import Settings

MANY = 100_000
"""Objects; telling the address, and the server's own settings, come to three thousand."""


@pytest.fixture(autouse=True)
def _unfrozen() -> Iterator[None]:
    yield
    gc.unfreeze()


def test_what_is_made_inside_is_not_looked_through_any_more() -> None:
    with for_good():
        assert not gc.isenabled()
        made: list[object] = [[]]
    assert gc.isenabled()
    assert gc.get_freeze_count() > 0
    assert not any(each is made for each in gc.get_objects())


def test_garbage_is_looked_for_again_where_it_fails() -> None:
    frozen = gc.get_freeze_count()
    with pytest.raises(ZeroDivisionError), for_good():
        raise ZeroDivisionError
    assert gc.isenabled()
    assert gc.get_freeze_count() == frozen


def test_collections_look_at_little_of_what_is_there_when_the_server_begins(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    looked_at: list[tuple[int, int]] = []

    def run(_: uvicorn.Server, sockets: list[socket.socket]) -> None:
        assert sockets
        looked_at.append((len(gc.get_objects()), gc.get_freeze_count()))

    def create_app(*_: object, **__: object) -> FastAPI:
        app = FastAPI()
        app.state.routes = [[] for _ in range(MANY)]
        return app

    monkeypatch.setattr(uvicorn.Server, "run", run)
    monkeypatch.setattr("service.app.create_app", create_app)
    owner = cast("Any", SimpleNamespace(bench_id="bench"))
    _serve(Settings(home=tmp_path, port=0), owner, Answer(None))
    [(walked, spared)] = looked_at
    assert spared > MANY
    assert walked < MANY / 10
