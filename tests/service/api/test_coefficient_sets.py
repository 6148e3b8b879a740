"""The life of a set over HTTP."""

import hashlib
from typing import Any

import h5py
import pytest
from fastapi.testclient import TestClient

from service.store.actor import Actor
from service.store.store import Store
from tests.service.store.a_store import a_set, certified, day, verified

PLACE = "/v1/coefficient-sets"
CERTIFY: dict[str, Any] = {"reason": "annual", "valid_from": "2026-01-01T00:00:00Z"}
LOOKUP = {"serial": "B0001", "band": "NIR", "gain": "0", "bit_depth": "12"}


@pytest.fixture
def store_url(url: str) -> str:
    """Each test on SQLite and on PostgreSQL."""
    return url


def test_a_set_is_verified_certified_found_and_revoked(client: TestClient, store: Store) -> None:
    set_id = store.sets.add(a_set(), by=Actor("ada")).id
    place = f"{PLACE}/{set_id}"
    assert client.post(f"{place}/verify", json={}).json()["state"] == "verified"
    certified_answer = client.post(f"{place}/certify", json=CERTIFY)
    assert certified_answer.status_code == 200
    assert certified_answer.json()["certification"]["valid_from"] == "2026-01-01T00:00:00Z"
    found = client.get(f"{PLACE}/lookup", params={**LOOKUP, "at": "2026-06-01T00:00:00Z"})
    assert found.json()["id"] == set_id
    revoked = client.post(f"{place}/revoke", json={"reason": "lamp 3 was off"})
    assert revoked.json()["state"] == "revoked"
    gone = client.get(f"{PLACE}/lookup", params={**LOOKUP, "at": "2026-06-01T00:00:00Z"})
    assert (gone.status_code, gone.json()["code"]) == (404, "not-found")


def test_an_illegal_step_is_a_conflict(client: TestClient, store: Store) -> None:
    place = f"{PLACE}/{store.sets.add(a_set(), by=Actor('ada')).id}"
    for step, body in (("certify", CERTIFY), ("revoke", {"reason": "b"})):
        answer = client.post(f"{place}/{step}", json=body)
        assert (answer.status_code, answer.json()["code"]) == (409, "illegal-transition")


def test_an_overlap_names_what_stands_in_the_way(client: TestClient, store: Store) -> None:
    standing = certified(store, a_set(30.0), day(1)).id
    later = verified(store, a_set(31.0)).id
    answer = client.post(f"{PLACE}/{later}/certify", json=CERTIFY)
    assert (answer.status_code, answer.json()["code"]) == (409, "overlapping-certification")
    assert answer.json()["standing"] == [standing]
    wanted = {**CERTIFY, "valid_from": "2026-05-01T00:00:00Z", "supersedes": [standing]}
    assert client.post(f"{PLACE}/{later}/certify", json=wanted).status_code == 200
    before = client.get(f"{PLACE}/lookup", params={**LOOKUP, "at": "2026-04-01T00:00:00Z"})
    assert before.json()["id"] == standing
    assert before.json()["state"] == "superseded"


def test_the_tag_of_a_record_changes_with_its_state_alone(client: TestClient, store: Store) -> None:
    place = f"{PLACE}/{store.sets.add(a_set(), by=Actor('ada')).id}"
    tag = client.get(place).headers["ETag"]
    unchanged = client.get(place, headers={"If-None-Match": tag})
    assert (unchanged.status_code, unchanged.content) == (304, b"")
    client.post(f"{place}/verify", json={})
    changed = client.get(place, headers={"If-None-Match": tag})
    assert changed.status_code == 200
    assert changed.headers["ETag"] != tag


def test_the_file_is_the_set_and_its_tag_its_id(client: TestClient, store: Store) -> None:
    set_id = store.sets.add(a_set(), by=Actor("ada")).id
    answer = client.get(f"{PLACE}/{set_id}/file")
    kept = store.sets.files.path(set_id).read_bytes()
    assert hashlib.sha256(answer.content).digest() == hashlib.sha256(kept).digest()
    assert answer.headers["ETag"] == f'"{set_id}"'
    again = client.get(f"{PLACE}/{set_id}/file", headers={"If-None-Match": f'"{set_id}"'})
    assert again.status_code == 304


def test_an_altered_file_is_not_handed_out(client: TestClient, store: Store) -> None:
    set_id = store.sets.add(a_set(), by=Actor("ada")).id
    with h5py.File(store.sets.files.path(set_id), "a") as file:
        file["dark_offset_dn"][0] += 1.0
    answer = client.get(f"{PLACE}/{set_id}/file")
    assert (answer.status_code, answer.json()["code"]) == (422, "altered")


def test_lists_come_in_pages_and_are_filtered(client: TestClient, store: Store) -> None:
    ids = [store.sets.add(a_set(30.0 + i), by=Actor("ada")).id for i in range(3)]
    first = client.get(PLACE, params={"limit": 2}).json()
    second = client.get(PLACE, params={"limit": 2, "before": first["next_before"]}).json()
    assert [each["id"] for each in first["items"] + second["items"]] == ids[::-1]
    assert second["next_before"] is None
    assert client.get(PLACE, params={"state": "certified"}).json()["items"] == []


@pytest.mark.parametrize(
    ("body", "where"),
    [
        ({**CERTIFY, "valid_from": "2026-01-01T00:00:00"}, "body.valid_from"),
        ({**CERTIFY, "reason": ""}, "body.reason"),
        ({**CERTIFY, "by": "ada"}, "body.by"),
        ({**CERTIFY, "valid_untill": "2027-01-01T00:00:00Z"}, "body.valid_untill"),
        ({}, "body.reason"),
    ],
)
def test_a_request_with_a_mistake_says_where(
    client: TestClient, store: Store, body: dict[str, Any], where: str
) -> None:
    set_id = verified(store, a_set()).id
    answer = client.post(f"{PLACE}/{set_id}/certify", json=body)
    assert (answer.status_code, answer.json()["code"]) == (422, "invalid-request")
    assert where in {".".join(each["where"]) for each in answer.json()["errors"]}
    assert store.sets.get(set_id).state == "verified"


def test_what_is_unknown_is_not_found(client: TestClient) -> None:
    for place in ("nobody", "0" * 64, "%00", "..%2F..%2Fetc"):
        answer = client.get(f"{PLACE}/{place}")
        assert answer.status_code == 404
        assert answer.headers["Content-Type"] == "application/problem+json"
