"""Who may do what: every operation against every key, and how tries are slowed down."""

import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from fastapi.testclient import TestClient

from service.api.failures import Failures
from service.app import create_app
from service.settings import Settings
from service.store.actor import Actor
from service.store.keys import Scope
from service.store.store import Store

NEEDED: dict[tuple[str, str], Scope | None] = {
    ("GET", "/healthz"): None,
    ("GET", "/readyz"): None,
    ("GET", "/metrics"): Scope.READ,
    ("GET", "/v1/bench"): Scope.READ,
    ("POST", "/v1/bench/look"): Scope.OPERATE,
    ("POST", "/v1/bench/release"): Scope.OPERATE,
    ("POST", "/v1/safe-off"): Scope.OPERATE,
    ("GET", "/v1/runs"): Scope.READ,
    ("POST", "/v1/runs"): Scope.OPERATE,
    ("GET", "/v1/runs/{run_id}"): Scope.READ,
    ("GET", "/v1/runs/{run_id}/events"): Scope.READ,
    ("GET", "/v1/runs/{run_id}/journal"): Scope.READ,
    ("POST", "/v1/runs/{run_id}/pause"): Scope.OPERATE,
    ("POST", "/v1/runs/{run_id}/resume"): Scope.OPERATE,
    ("POST", "/v1/runs/{run_id}/abort"): Scope.OPERATE,
    ("GET", "/v1/recordings"): Scope.READ,
    ("GET", "/v1/recordings/{digest}"): Scope.READ,
    ("POST", "/v1/recordings"): Scope.OPERATE,
    ("GET", "/v1/recordings/{digest}/file"): Scope.READ,
    ("DELETE", "/v1/recordings/{digest}"): Scope.ADMIN,
    ("POST", "/v1/calibrations"): Scope.OPERATE,
    ("POST", "/v1/photon-transfers"): Scope.OPERATE,
    ("POST", "/v1/diagnoses"): Scope.OPERATE,
    ("POST", "/v1/transfer-functions"): Scope.OPERATE,
    ("GET", "/v1/jobs"): Scope.READ,
    ("GET", "/v1/jobs/{job_id}"): Scope.READ,
    ("GET", "/v1/jobs/{job_id}/files/{name}"): Scope.READ,
    ("POST", "/v1/jobs/{job_id}/cancel"): Scope.OPERATE,
    ("GET", "/v1/coefficient-sets"): Scope.READ,
    ("GET", "/v1/coefficient-sets/lookup"): Scope.READ,
    ("GET", "/v1/coefficient-sets/{set_id}"): Scope.READ,
    ("GET", "/v1/coefficient-sets/{set_id}/file"): Scope.READ,
    ("POST", "/v1/coefficient-sets/{set_id}/verify"): Scope.OPERATE,
    ("POST", "/v1/coefficient-sets/{set_id}/certify"): Scope.CERTIFY,
    ("POST", "/v1/coefficient-sets/{set_id}/revoke"): Scope.CERTIFY,
    ("POST", "/v1/coefficient-sets/{set_id}/apply"): Scope.READ,
    ("GET", "/v1/audit"): Scope.READ,
    ("GET", "/v1/audit/verify"): Scope.READ,
}


@pytest.fixture(scope="module")
def home(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("home")


@pytest.fixture(scope="module")
def keys(home: Path) -> dict[Scope | None, str]:
    with Store.open(Settings(home=home)) as store:
        made: dict[Scope | None, str] = {
            scope: store.keys.create(str(scope), scope, expires_at=None, by=Actor("root"))[1]
            for scope in Scope
        }
        gone = store.keys.create("gone", Scope.ADMIN, expires_at=None, by=Actor("root"))
        store.keys.revoke(gone[0].id, by=Actor("root"))
    return {**made, None: gone[1]}


@pytest.fixture(scope="module")
def client(home: Path, keys: dict[Scope | None, str]) -> Iterator[TestClient]:
    del keys  # are on record before anybody asks
    app = create_app(Settings(home=home))
    with TestClient(app, base_url="http://127.0.0.1", raise_server_exceptions=False) as started:
        yield started


def test_the_table_holds_every_operation(client: TestClient) -> None:
    document = client.get("/openapi.json").json()
    offered = {(m.upper(), p) for p, methods in document["paths"].items() for m in methods}
    assert offered == set(NEEDED)


@pytest.mark.parametrize("scope", Scope)
@pytest.mark.parametrize(("method", "path"), NEEDED, ids=lambda x: x)
def test_a_key_opens_what_its_scope_includes(
    client: TestClient, keys: dict[Scope | None, str], method: str, path: str, scope: Scope
) -> None:
    needed = NEEDED[method, path]
    answer = client.request(method, path, headers={"Authorization": f"Bearer {keys[scope]}"})
    if needed is None or scope.includes(needed):
        assert answer.status_code not in {401, 403}
    else:
        assert (answer.status_code, answer.json()["code"]) == (403, "scope-missing")


@pytest.mark.parametrize(("method", "path"), [k for k, v in NEEDED.items() if v], ids=lambda x: x)
def test_nothing_is_answered_without_a_key_once_there_is_one(
    client: TestClient, method: str, path: str
) -> None:
    answer = client.request(method, path)
    assert (answer.status_code, answer.json()["code"]) == (401, "key-needed")
    assert answer.headers["WWW-Authenticate"] == "Bearer"


def test_a_key_that_is_over_opens_nothing_and_tries_are_slowed_down(
    client: TestClient, keys: dict[Scope | None, str]
) -> None:
    headers = {"Authorization": f"Bearer {keys[None]}"}
    took = []
    for _ in range(4):
        began = time.monotonic()
        answer = client.get("/v1/runs", headers=headers)
        took.append(time.monotonic() - began)
        assert (answer.status_code, answer.json()["code"]) == (401, "key-refused")
    assert took[3] >= 0.4  # 0.1 s, doubled twice
    good = {"Authorization": f"Bearer {keys[Scope.READ]}"}
    assert client.get("/v1/runs", headers=good).status_code == 200


def test_failures_are_counted_by_address_and_forgotten_after_a_good_key() -> None:
    failures = Failures()
    for _ in range(20):
        failures.count("10.0.0.1")
    assert failures.wait_s("10.0.0.1") == 5.0
    assert failures.wait_s("10.0.0.2") == 0.0
    failures.forget("10.0.0.1")
    assert failures.wait_s("10.0.0.1") == 0.0


def test_without_keys_this_machine_alone_is_served(tmp_path: Path) -> None:
    app = create_app(Settings(home=tmp_path))
    for address, status in (("127.0.0.1", 200), ("::1", 200), ("10.0.0.1", 401)):
        with TestClient(app, base_url="http://127.0.0.1", client=(address, 50_000)) as client:
            assert client.get("/v1/runs").status_code == status
