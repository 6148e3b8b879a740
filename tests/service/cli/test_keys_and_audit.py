"""Keys and the audit log, by commands."""

import sqlite3
from collections.abc import Callable
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest

from service.settings import Settings
from service.store.store import Store
from tests.service.cli.answers import Ran

Run = Callable[..., Ran]


def test_a_key_is_made_told_once_listed_and_revoked(run: Run, home: Path) -> None:
    made = run("key", "create", "control PC", "--scope", "operate", "--expires", "90d",
               "--by", "ada", "--json", "-").json  # fmt: skip
    until = datetime.fromisoformat(made["expires_at"]) - datetime.now(UTC)
    assert timedelta(days=89.9) < until <= timedelta(days=90)
    with Store.open(Settings(home=home)) as store:
        known = store.keys.known(made["key"])
        assert known is not None
        assert (known.id, known.scope.value, known.name) == (made["id"], "operate", "control PC")
        listed = run("key", "list", "--json", "-")
        assert [each["id"] for each in listed.json["items"]] == [made["id"]]
        assert made["key"].split("_", 2)[2] not in listed.stdout
        assert run("key", "revoke", made["id"], "--json", "-").json["good"] is False
        assert store.keys.known(made["key"]) is None
    assert "revoked" in run("key", "list").stdout
    entries = run("audit", "list", "--json", "-").json["items"]
    assert [(e["action"], e["subject"]) for e in entries] == [
        ("key.revoke", made["id"]), ("key.create", made["id"]),
    ]  # fmt: skip
    assert entries[1]["who"] == "ada"


def test_people_get_the_key_alone_on_a_line(run: Run, home: Path) -> None:
    key = run("key", "create", "pc").stdout
    with Store.open(Settings(home=home)) as store:
        known = store.keys.known(key.strip())
    assert key.count("\n") == 1
    assert known is not None
    assert (known.scope.value, known.expires_at) == ("read", None)


@pytest.mark.parametrize("time", ["90", "d", "0d", "-1d", "1.5d", "9999999w", "90 days"])
def test_what_is_no_time_is_wrong_usage(run: Run, time: str) -> None:
    assert run("key", "create", "pc", "--expires", time).status == 2


def test_a_key_that_is_not_there(run: Run) -> None:
    assert run("key", "revoke", "0123", "--json", "-").error_code == "not-found"
    assert run("key", "create", " ", "--json", "-").error_code == "no-name"


def test_the_log_is_proven_and_its_first_broken_entry_named(run: Run, home: Path) -> None:
    for n in range(4):
        run("key", "create", f"pc {n}")
    whole = run("audit", "verify", "--json", "-").json
    assert whole["entries"] == 4
    assert whole["digest"] in run("audit", "verify").stdout
    assert run("audit", "verify", "--expect", whole["digest"]).status == 0
    assert run("audit", "verify", "--expect", "0" * 63 + "1", "--json", "-").error_code == (
        "audit-cut-off"
    )
    with sqlite3.connect(home / "store.sqlite3") as database:
        database.execute("UPDATE audit SET who = 'eve' WHERE number = 3")
    database.close()
    broken = run("audit", "verify", "--json", "-")
    assert (broken.status, broken.error_code) == (1, "audit-broken")
    assert "entry 3" in broken.stderr
