"""The audit log by REST: in pages, and proven."""

from fastapi.testclient import TestClient
from sqlalchemy import text

from service.store.actor import Actor
from service.store.engine import writing_session
from service.store.store import Store

ADA = Actor("ada", "0123456789abcdef")


def fill(store: Store, n: int) -> None:
    for k in range(n):
        store.audit.record(ADA, "bench.safe-off", f"bench {k}", after={"level": k})


def test_every_entry_is_in_one_page_newest_first(client: TestClient, store: Store) -> None:
    fill(store, 7)
    numbers, before = [], None
    while True:
        query = {"limit": 3} | ({} if before is None else {"before": before})
        page = client.get("/v1/audit", params=query).json()
        numbers += [each["number"] for each in page["items"]]
        assert {each["who"] for each in page["items"]} == {"ada"}
        before = page["next_before"]
        if before is None:
            break
    assert numbers == [7, 6, 5, 4, 3, 2, 1]


def test_a_whole_log_is_proven_and_one_that_was_changed_is_a_problem(
    client: TestClient, store: Store
) -> None:
    fill(store, 4)
    last = client.get("/v1/audit", params={"limit": 1}).json()["items"][0]["digest"]
    assert client.get("/v1/audit/verify").json() == {"entries": 4, "digest": last}
    with writing_session(store._engine) as session:
        session.execute(text("UPDATE audit SET who = 'eve' WHERE number = 2"))
    answer = client.get("/v1/audit/verify")
    assert (answer.status_code, answer.json()["code"]) == (503, "audit-broken")
    assert "audit entry 2" in answer.json()["detail"]
