"""What a server that is about to answer has done: nothing here is timed."""

import gc
import socket

import pytest
import uvicorn
from fastapi import FastAPI

from service.cli.listening import serve_until_stopped


def test_collections_look_at_little_of_what_is_there_when_the_server_begins(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    looked_at: list[tuple[int, int]] = []

    def run(_: uvicorn.Server, sockets: list[socket.socket]) -> None:
        assert sockets
        looked_at.append((len(gc.get_objects()), gc.get_freeze_count()))

    monkeypatch.setattr(uvicorn.Server, "run", run)
    try:
        with socket.create_server(("127.0.0.1", 0)) as listening:
            serve_until_stopped(FastAPI(), listening)
    finally:
        gc.unfreeze()
    [(walked, spared)] = looked_at
    assert walked < 0.01 * spared
