"""Runs by REST: queued, followed, paused, aborted, gone on with."""

import json
import os
import time
from collections.abc import Iterator
from datetime import datetime
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient
from sqlalchemy import delete

from service.app import create_app
from service.settings import Settings
from service.store.actor import Actor
from service.store.engine import writing_session
from service.store.keys import Scope
from service.store.run_records import FINAL
from service.store.store import Store
from service.store.tables import KeyRow
from tests.service.owner.serving import slow_plan
from tests.service.sequencer.benches import in_process, short_plan

RUNS = "/v1/runs"
SLOW: dict[str, Any] = slow_plan().model_dump(mode="json")
SHORT: dict[str, Any] = short_plan().model_dump(mode="json")


@pytest.fixture(scope="module")
def home(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("home")


@pytest.fixture(scope="module")
def client(home: Path) -> Iterator[TestClient]:
    app = create_app(Settings(home=home), bench_settings=in_process(f"api-{os.getpid()}"))
    with TestClient(app, base_url="http://127.0.0.1", raise_server_exceptions=False) as started:
        until(started, "/v1/bench", "idle")
        yield started


def until(client: TestClient, place: str, *states: str, within_s: float = 60.0) -> dict[str, Any]:
    deadline = time.monotonic() + within_s
    while time.monotonic() < deadline:
        answer: dict[str, Any] = client.get(place).json()
        if answer["state"] in states:
            return answer
        time.sleep(0.05)
    raise AssertionError(answer)


def start(client: TestClient, plan: dict[str, Any], **headers: str) -> str:
    answer = client.post(RUNS, json=plan, headers=headers)
    assert answer.status_code == 202, answer.text
    place: str = answer.headers["Location"]
    return place


def test_a_run_is_recorded_and_registered(client: TestClient) -> None:
    run = until(client, start(client, SHORT), *FINAL)
    assert run["state"] == "succeeded", run
    assert (run["blocks_done"], run["blocks_total"]) == (4, 4)
    recording = client.get(f"/v1/recordings/{run['recording']}").json()
    assert recording["digest"] == run["recording"]


def test_validate_moves_nothing(client: TestClient) -> None:
    before = client.get(RUNS).json()
    answer = client.post(RUNS, params={"validate": "true"}, json=SHORT)
    assert answer.status_code == 200
    assert [step["kind"] for step in answer.json()["steps"]] == ["dark", "flat"] * 2
    assert client.get(RUNS).json() == before


def test_a_plan_with_a_typo_is_refused_with_its_place(client: TestClient) -> None:
    answer = client.post(RUNS, json={**SHORT, "lightes": 3})
    assert answer.status_code == 422
    assert answer.json()["code"] == "plan-invalid"
    assert "lightes" in answer.json()["detail"]


def test_events_can_be_caught_up_with_and_have_no_gap(client: TestClient) -> None:
    place = start(client, SHORT)
    until(client, place, *FINAL)
    polled = client.get(f"{place}/journal").json()
    streamed = events(client, place)
    assert [e["number"] for e in streamed] == list(range(1, len(polled) + 1))
    assert streamed == polled
    assert events(client, place, after=3) == polled[3:]
    states = [e["content"]["state"] for e in polled if e["kind"] == "state"]
    assert states == ["queued", "running", "succeeded"]


def events(client: TestClient, place: str, after: int | None = None) -> list[dict[str, Any]]:
    headers = {} if after is None else {"Last-Event-ID": str(after)}
    with client.stream("GET", f"{place}/events", headers=headers) as stream:
        lines = list(stream.iter_lines())
    return [json.loads(line[6:]) for line in lines if line.startswith("data: ")]


def test_a_stream_ends_with_the_run(client: TestClient) -> None:
    place = start(client, SHORT)
    streamed = events(client, place)
    assert streamed[-1]["content"]["state"] == "succeeded"
    assert client.get(place).json()["state"] == "succeeded"


def test_pause_resume_and_abort(client: TestClient) -> None:
    place = start(client, SLOW)
    until(client, place, "running")
    assert client.post(f"{place}/pause").json()["state"] in {"pausing", "paused"}
    until(client, place, "paused")
    assert client.post(f"{place}/pause").status_code == 200
    look = client.post("/v1/bench/look").json()
    assert next(d for d in look if d["role"] == "light")["values"]["level"] == 0.0
    assert client.post(f"{place}/resume").json()["state"] == "running"
    assert client.post(f"{place}/abort").json()["state"] == "aborting"
    assert until(client, place, *FINAL)["state"] == "cancelled"
    assert client.post(f"{place}/abort").status_code == 200
    refused = client.post(f"{place}/pause")
    assert (refused.status_code, refused.json()["code"]) == (409, "illegal-transition")
    assert client.post(f"{place}/resume").json()["state"] == "queued"
    run = until(client, place, "succeeded")
    assert run["attempts"] == 2


def test_one_key_gives_one_run(client: TestClient) -> None:
    first = start(client, SHORT, **{"Idempotency-Key": "sweep 7"})
    assert start(client, SHORT, **{"Idempotency-Key": "sweep 7"}) == first
    other = client.post(RUNS, json=SLOW, headers={"Idempotency-Key": "sweep 7"})
    assert (other.status_code, other.json()["code"]) == (409, "idempotency-mismatch")
    until(client, first, *FINAL)


def test_a_second_client_waits_is_told_who_holds_the_bench_and_may_switch_off(
    client: TestClient, home: Path
) -> None:
    with Store.open(Settings(home=home)) as store:
        ada = key(store, "ada")
        bob = key(store, "bob")
        try:
            place = start(client, SLOW, **ada)
            waiting = start(client, SLOW, **bob)
            while client.get(place, headers=bob).json()["state"] != "running":
                time.sleep(0.05)
            assert client.get("/v1/bench", headers=bob).json()["held_by"] == "ada"
            for command in ("pause", "resume", "abort"):
                held = client.post(f"{place}/{command}", headers=bob)
                assert (held.status_code, held.json()["code"]) == (423, "bench-held")
                assert "ada" in held.json()["detail"]
            assert client.get(waiting, headers=bob).json()["state"] == "queued"
            off = client.post("/v1/safe-off", headers=bob).json()
            assert off["dark"]
            while client.get(place, headers=bob).json()["state"] not in FINAL:
                time.sleep(0.05)
            assert client.get(place, headers=ada).json()["state"] == "cancelled"
            assert client.get("/v1/bench", headers=ada).json()["kept_dark"]["by"] == "bob"
            released = client.post("/v1/bench/release", headers=ada).json()
            assert released["kept_dark"] is None
            while client.get(waiting, headers=bob).json()["state"] == "queued":
                time.sleep(0.05)
            began = client.get(waiting, headers=bob).json()["started_at"]
            (release,) = (e for e in store.audit.list().items if e.action == "bench.release")
            assert datetime.fromisoformat(began) >= release.at
            assert (release.who, release.before) == ("ada", {"kept_dark_by": "bob"})
            client.post(f"{waiting}/abort", headers=bob)
            assert client.get("/v1/bench").status_code == 401
        finally:
            forget_keys(store)


def key(store: Store, name: str) -> dict[str, str]:
    made = store.keys.create(name, Scope.OPERATE, expires_at=None, by=Actor("root"))[1]
    return {"Authorization": f"Bearer {made}"}


def forget_keys(store: Store) -> None:
    with writing_session(store._engine) as session:
        session.execute(delete(KeyRow))
