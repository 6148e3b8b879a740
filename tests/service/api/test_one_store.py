"""The command line and the service share one store: what one adds, the other finds."""

import time
from collections.abc import Callable
from pathlib import Path

import pytest
from fastapi.testclient import TestClient
from typer.testing import CliRunner

from calib.recording.open import open_recording
from service.cli.app import app
from service.settings import Settings
from tests.service.cli.answers import Ran

Run = Callable[..., Ran]
CAMERA: dict[str, str | float] = {"serial": "D0001", "band": "NIR", "gain": 0.0, "bit_depth": 12}


@pytest.fixture
def run(settings: Settings, monkeypatch: pytest.MonkeyPatch) -> Run:
    """Run `darkflat` with the service's store."""
    monkeypatch.setenv("DARKFLAT_HOME", str(settings.home))

    def in_process(*arguments: object) -> Ran:
        ran = CliRunner().invoke(app, [str(each) for each in arguments])
        return Ran(ran.exit_code, ran.stdout, ran.stderr)

    return in_process


def test_a_set_made_and_certified_by_commands_is_the_one_that_the_service_finds(
    run: Run, client: TestClient, recording_file: Path, tmp_path: Path
) -> None:
    made = run("calibrate", recording_file, "--out", tmp_path / "set.h5", "--store", "--json", "-")
    assert made.status == 0
    set_id = made.json["coefficient_set"]
    found = client.get(f"/v1/coefficient-sets/{set_id}").json()
    assert found["state"] == "draft"
    recording = client.get(f"/v1/recordings/{found['recording_digest']}")
    assert recording.status_code == 200
    assert recording.json()["name"] == recording_file.name
    assert run("store", "verify", set_id).status == 0
    certified = ("store", "certify", set_id, "--from", "2026-01-01", "--reason", "annual")
    assert run(*certified).status == 0
    at = {**CAMERA, "at": "2026-07-01T00:00:00Z"}
    looked_up = client.get("/v1/coefficient-sets/lookup", params=at)
    assert looked_up.status_code == 200
    assert looked_up.json()["id"] == set_id


def test_a_recording_that_a_command_made_known_is_calibrated_by_the_service(
    run: Run, client: TestClient, recording_file: Path
) -> None:
    added = run("store", "add-recording", recording_file, "--by", "ada", "--json", "-")
    assert added.status == 0
    digest = added.json["digest"]
    assert digest == open_recording(recording_file).digest()
    assert client.get(f"/v1/recordings/{digest}").json()["registered_by"] == "ada"
    started = client.post("/v1/calibrations", json={"recording": digest})
    until = time.monotonic() + 240
    while (job := client.get(started.headers["Location"]).json())["state"] in {"queued", "running"}:
        assert time.monotonic() < until
        time.sleep(0.05)
    assert job["state"] == "succeeded", job["error"]
    listed = run("store", "list", "--json", "-").json["items"]
    assert [each["id"] for each in listed] == [job["result"]["coefficient_set"]]


def test_a_recording_that_is_known_stays_where_it_is_found(
    run: Run, recording_file: Path, tmp_path: Path
) -> None:
    from_here = run("store", "add-recording", recording_file, "--json", "-").json
    copy = tmp_path / "copy.h5"
    assert run("export", recording_file, "--out", tmp_path / "folder").status == 0
    assert run("import", tmp_path / "folder", "--out", copy).status == 0
    again = run("store", "add-recording", copy, "--json", "-").json
    assert (again["digest"], again["path"]) == (from_here["digest"], from_here["path"])


def test_a_recording_whose_file_is_gone_is_found_at_its_new_place(
    run: Run, recording_file: Path, tmp_path: Path
) -> None:
    assert run("export", recording_file, "--out", tmp_path / "folder").status == 0
    for name in ("first.h5", "second.h5"):
        assert run("import", tmp_path / "folder", "--out", tmp_path / name).status == 0
    run("store", "add-recording", tmp_path / "first.h5")
    (tmp_path / "first.h5").unlink()
    moved = run("store", "add-recording", tmp_path / "second.h5", "--json", "-").json
    assert moved["path"] == str(tmp_path / "second.h5")


def test_what_is_no_recording_is_not_made_known(run: Run, tmp_path: Path) -> None:
    ran = run("store", "add-recording", tmp_path / "nowhere.h5", "--json", "-")
    assert ran.status == 1
    assert len(ran.stderr.strip().splitlines()) == 1
    assert not (tmp_path / "home" / "store.sqlite3").exists()


def test_a_store_that_takes_nothing_is_said_before_the_calibration(
    run: Run, recording_file: Path, tmp_path: Path
) -> None:
    (tmp_path / "home").write_text("a file where a folder should be")
    ran = run("calibrate", recording_file, "--out", tmp_path / "set.h5", "--store", "--json", "-")
    assert (ran.status, ran.error_code) == (1, "store-not-writable")
    assert not (tmp_path / "set.h5").exists()
