"""How late the service may be to learn of keys, and how seldom it asks."""

import asyncio
import time
from datetime import UTC, datetime, timedelta

from fastapi.testclient import TestClient

from service.api.key_ring import STALE_S, KeyRing
from service.store.actor import Actor
from service.store.keys import KeyBook, Keys, Scope
from service.store.store import Store

ROOT = Actor("root")


def _made(store: Store, name: str = "pc", expires_at: datetime | None = None) -> tuple[str, str]:
    record, key = store.keys.create(name, Scope.READ, expires_at=expires_at, by=ROOT)
    return record.id, key


def _asked(client: TestClient, key: str | None) -> tuple[int, str]:
    headers = {} if key is None else {"Authorization": f"Bearer {key}"}
    answer = client.get("/v1/runs", headers=headers)
    return answer.status_code, answer.json().get("code", "")


def test_a_key_that_is_revoked_elsewhere_opens_nothing_once_it_is_stale(
    client: TestClient, store: Store
) -> None:
    (first, key), (_, other) = _made(store), _made(store)
    assert _asked(client, key) == _asked(client, other) == (200, "")
    store.keys.revoke(first, by=ROOT)
    time.sleep(STALE_S)
    assert _asked(client, key) == (401, "key-refused")
    assert _asked(client, other) == (200, "")


def test_a_key_that_is_made_elsewhere_opens_at_once(client: TestClient, store: Store) -> None:
    assert _asked(client, _made(store)[1]) == (200, "")
    assert _asked(client, _made(store)[1]) == (200, "")


def test_the_first_key_keeps_out_who_has_none(client: TestClient, store: Store) -> None:
    assert _asked(client, None) == (200, "")
    _made(store)
    time.sleep(STALE_S)
    assert _asked(client, None) == (401, "key-needed")


def test_a_key_expires_to_the_moment(store: Store) -> None:
    until = datetime.now(UTC) + timedelta(seconds=1)
    _, key = _made(store, expires_at=until)
    book = store.keys.read()
    assert book.known(key) is not None
    time.sleep(max(0.0, (until - datetime.now(UTC)).total_seconds()))
    assert book.known(key) is None


class _Counted(Keys):
    def __init__(self, keys: Keys) -> None:
        super().__init__(keys._engine)
        self.count = 0

    def read(self) -> KeyBook:
        self.count += 1
        return super().read()


def test_the_store_is_asked_once_for_all_requests_of_a_while(store: Store) -> None:
    _, key = _made(store)
    keys = _Counted(store.keys)
    ring = KeyRing(keys)

    async def ask_for(seconds: float) -> None:
        until_s = time.monotonic() + seconds
        while time.monotonic() < until_s:
            assert all(await asyncio.gather(*(ring.known(key) for _ in range(50))))
            await asyncio.sleep(STALE_S / 20)

    began_s = time.monotonic()
    asyncio.run(ask_for(2 * STALE_S))
    took_s = time.monotonic() - began_s
    assert 2 <= keys.count <= took_s / STALE_S + 1
