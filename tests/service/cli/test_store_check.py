"""`darkflat store check` answers for scripts and for people."""

from collections.abc import Callable
from pathlib import Path

from service.settings import Settings
from tests.service.cli.answers import Ran
from tests.service.store.a_store import a_set

Run = Callable[..., Ran]


def test_a_whole_store_is_status_0_and_a_loss_is_status_1(
    run: Run, home: Path, tmp_path: Path
) -> None:
    assert run("store", "check", "--json", "-").error_code == "no-store"
    assert not home.exists()
    a_set().save(tmp_path / "set.h5")
    set_id = run("store", "add", tmp_path / "set.h5", "--json", "-").json["id"]
    whole = run("store", "check", "--json", "-")
    assert whole.status == 0
    assert (whole.json["whole"], whole.json["findings"]) == (True, [])
    assert (whole.json["coefficient_sets"], whole.json["audit_entries"]) == (1, 1)
    kept = Settings(home=home).sets_folder / f"{set_id}.h5"
    stray = kept.rename(kept.with_name("stray.h5"))
    broken = run("store", "check", "--json", "-")
    assert broken.status == 1
    assert broken.json["whole"] is False
    assert [(f["kind"], f["subject"], f["path"]) for f in broken.json["findings"]] == [
        ("orphaned", "stray.h5", str(stray)), ("missing", set_id, str(kept)),
    ]  # fmt: skip
    assert len(broken.stderr.strip().splitlines()) == 1
    assert "restore it from a copy" in " ".join(run("store", "check").stdout.split())
