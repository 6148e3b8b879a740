"""The life of a set, by commands."""

from collections.abc import Callable
from pathlib import Path

import pytest

from tests.service.cli.answers import Ran
from tests.service.store.a_store import a_set

Run = Callable[..., Ran]
LOOKUP = ("store", "lookup", "--serial", "B0001", "--band", "NIR", "--bit-depth", 12)


@pytest.fixture
def added(run: Run, tmp_path: Path) -> str:
    a_set().save(tmp_path / "set.h5")
    ran = run("store", "add", tmp_path / "set.h5", "--by", "ada", "--json", "-")
    assert ran.status == 0
    assert ran.json["state"] == "draft"
    return str(ran.json["id"])


def test_a_set_goes_from_draft_to_revoked(run: Run, added: str) -> None:
    short = added[:10]
    assert run("store", "verify", short, "--json", "-").json["state"] == "verified"
    certified = run(
        "store", "certify", short, "--from", "2026-01-01", "--until", "2027-01-01T12:00:00",
        "--reason", "annual", "--json", "-",
    )  # fmt: skip
    assert certified.json["certification"]["valid_from"] == "2026-01-01T00:00:00+00:00"
    found = run(*LOOKUP, "--at", "2026-07-01", "--json", "-")
    assert found.json["id"] == added
    assert Path(found.json["path"]).is_file()
    assert run(*LOOKUP, "--at", "2027-01-01T12:00:00", "--json", "-").error_code == "not-found"
    revoked = run("store", "revoke", short, "--reason", "lamp 3 was off", "--json", "-")
    assert [step["after"] for step in revoked.json["transitions"]] == [
        "draft", "verified", "certified", "revoked",
    ]  # fmt: skip
    assert run(*LOOKUP, "--at", "2026-07-01", "--json", "-").status == 1


def test_an_illegal_step_is_status_1_and_one_line(run: Run, added: str) -> None:
    ran = run("store", "revoke", added, "--reason", "why not", "--json", "-")
    assert (ran.status, ran.error_code) == (1, "illegal-transition")
    assert len(ran.stderr.strip().splitlines()) == 1


def test_people_read_the_same_in_tables(run: Run, added: str) -> None:
    assert added[:12] in run("store", "list").stdout
    assert added in run("store", "show", added[:12]).stdout


def test_lists_are_filtered(run: Run, added: str) -> None:
    assert len(run("store", "list", "--state", "draft", "--json", "-").json["items"]) == 1
    assert run("store", "list", "--state", "certified", "--json", "-").json["items"] == []
    assert run("store", "list", "--state", "nonsense").status == 2


def test_a_certified_set_is_applied_by_its_id_within_its_validity(
    run: Run, added: str, tmp_path: Path
) -> None:
    import numpy as np

    np.save(tmp_path / "lines.npy", np.full((4, 32), 500, np.uint16))
    lines = (tmp_path / "lines.npy", "--exposure-us", 200, "--json", "-")
    out = ("--out", tmp_path / "radiance.h5")
    assert run("apply", added[:12], *lines, *out).error_code == "not-certified"
    run("store", "verify", added)
    run("store", "certify", added, "--from", "2026-01-01", "--until", "2027-01-01", "--reason", "a")
    late = run("apply", added[:12], *lines, *out, "--at", "2027-06-01")
    assert late.error_code == "outside-validity"
    assert run("apply", added[:12], *lines, *out, "--at", "2026-06-01").status == 0
