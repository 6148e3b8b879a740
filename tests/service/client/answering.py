"""Clients without a network: of an app in this process, or of a function that is a service."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

import httpx2
from fastapi import FastAPI
from fastapi.testclient import TestClient

from service.client import Client


@contextmanager
def asking(app: FastAPI) -> Iterator[Client]:
    """Give a client of `app`, which is started and stopped: Starlette's is one of httpx2."""
    with (
        TestClient(app, base_url="http://127.0.0.1", raise_server_exceptions=False) as answering,
        Client() as client,
    ):
        client._link._http.close()
        client._link._http = answering
        yield client


def answered_by(service: Callable[[httpx2.Request], httpx2.Response]) -> Client:
    """Return a client whose requests are answered by `service`, for lines that break in time."""
    client = Client(patience_s=30.0)
    client._link._http.close()
    transport = httpx2.MockTransport(service)
    client._link._http = httpx2.Client(base_url="http://bench", transport=transport)
    return client
