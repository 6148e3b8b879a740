"""Photon transfer, diagnosis and MTF as jobs: the same answer as the commands', with files."""

import io
import json
import os
import shutil
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from fastapi.testclient import TestClient
from numpy.random import default_rng

from calib.errors import InputError, NotDeterminedError
from calib.forward.model import Model
from calib.mtf.geometry import Alignment
from calib.mtf.simulation.detector import DetectorNoise
from calib.mtf.simulation.folder import write_folder
from calib.recording.open import open_recording
from service.api.jobs.kinds.diagnosis import diagnose
from service.api.jobs.kinds.photon_transfer import photon_transfer
from service.api.jobs.kinds.transfer_function import transfer_function
from service.app import create_app
from service.cli.simulated_recording import simulate_recording
from service.plan.model import Plan
from service.settings import Settings
from service.store.store import Store
from tests.calib.mtf.simulated import ORDERS_12, SMALL, record
from tests.service.api.packing import as_files, packed
from tests.service.api.test_calibration_jobs import Asleep
from tests.service.api.test_calibrations import ended
from tests.service.cli.answers import Ran
from tests.service.cli.conftest import home, run

__all__ = ["home", "run"]

Run = Callable[..., Ran]
ZIP = {"Content-Type": "application/zip"}


def upload(client: TestClient, recording: Path) -> str:
    answer = client.post("/v1/recordings", content=as_files(recording), headers=ZIP)
    return str(answer.json()["digest"])


def files_of(client: TestClient, job: dict[str, Any]) -> dict[str, bytes]:
    """Download what a job left, and check that it is as its answer says."""
    found = {}
    for each in job["files"]:
        answer = client.get(each["place"])
        assert answer.status_code == 200
        assert answer.headers["Content-Type"].partition(";")[0] == each["media_type"]
        assert len(answer.content) == each["bytes"]
        assert answer.headers["Content-Security-Policy"].startswith("sandbox; default-src 'none'")
        found[each["name"]] = answer.content
    return found


def without_files(told: dict[str, Any]) -> dict[str, Any]:
    """Return an answer without the paths that a command wrote to."""
    return {name: value for name, value in told.items() if name not in {"written", "path"}}


@pytest.mark.usefixtures("here_and_now")
def test_a_photon_transfer_answers_as_the_command_and_leaves_its_data_sheet(
    client: TestClient, recording_file: Path, settings: Settings, run: Run
) -> None:
    digest = upload(client, recording_file)
    started = client.post("/v1/photon-transfers", json={"recording": digest})
    assert started.status_code == 202, started.text
    job = ended(client, started.headers["Location"])
    assert job["state"] == "succeeded", job["error"]
    kept = settings.recordings_folder / digest / "recording.h5"
    told = run("photon-transfer", kept, "--json", "-").json
    assert job["result"] == without_files(told)
    files = files_of(client, job)
    assert set(files) == {"answer.json", "data-sheet.json", "data-sheet.xml", "report.html"}
    assert json.loads(files["answer.json"]) == job["result"]
    assert b"<svg" in files["report.html"]
    assert str(client.get("/v1/jobs").json()["items"][0]["files"]) == str(job["files"])


def test_a_method_that_the_recording_does_not_allow_says_so_and_leaves_nothing(
    recording_file: Path, tmp_path: Path
) -> None:
    request = {"recording_path": recording_file, "method": "sanuc", "files": tmp_path}
    with pytest.raises(NotDeterminedError) as refused:
        photon_transfer(request, lambda _: None)
    assert refused.value.code == "not-doubled"
    assert list(tmp_path.iterdir()) == []


def test_a_diagnosis_leaves_its_page_and_the_amended_model(
    client: TestClient, recording_file: Path
) -> None:
    digest = upload(client, recording_file)
    camera, demo = open_recording(recording_file).header.camera, Model.preset("demo")
    model = Model(camera, demo.source, demo.effects).dumps()
    started = client.post("/v1/diagnoses", json={"recording": digest, "model": model})
    job = ended(client, started.headers["Location"])
    assert job["state"] == "succeeded", job["error"]
    assert job["result"]["verdict"] in {"consistent", "explained", "ambiguous", "unexplained"}
    files = files_of(client, job)
    assert set(files) == {"amended-model.toml", "answer.json", "report.html"}
    assert json.loads(files["answer.json"])["verdict"] == job["result"]["verdict"]
    assert Model.loads(files["amended-model.toml"].decode())
    assert "path" not in str(job["request"])


def test_what_cannot_be_diagnosed_leaves_a_page_that_says_why(tmp_path: Path) -> None:
    darks = [{"kind": "dark", "exposure_us": t, "level": 1} for t in (20.0, 50.0)]
    plan = Plan.parse(
        {
            "lines": 32,
            "sweep": {"type": "listed", "blocks": darks},
            "camera": {"line_period_us": 100.0, "columns": 64},
        }
    )
    recording, files = tmp_path / "darks.h5", tmp_path / "files"
    files.mkdir()
    simulate_recording(Model.preset("demo"), plan, recording, seed=2, scenes_folder=tmp_path)
    request = {"recording_paths": [recording], "names": ["d"], "model": None, "files": files}
    with pytest.raises(NotDeterminedError) as refused:
        diagnose(request, lambda _: None)
    assert refused.value.code == "no-flats"
    assert "cannot be diagnosed" in (files / "report.html").read_text()


@pytest.fixture
def scan(tmp_path: Path) -> Path:
    case = record(
        default_rng(), (40, 40), scan=SMALL, grating=ORDERS_12,
        alignment=Alignment(np.array([11.0, -23.0])),
        detector=DetectorNoise(shot_noise=True, averaged=100),
    )  # fmt: skip
    return write_folder(tmp_path / "scan", SMALL, ORDERS_12, case.scan.images)


def zipped(folder: Path) -> bytes:
    files = [path for path in folder.rglob("*") if path.is_file()]
    return packed({str(path.relative_to(folder.parent)): path.read_bytes() for path in files})


def test_a_scan_becomes_a_transfer_function_as_by_the_command(
    client: TestClient, scan: Path, tmp_path: Path, run: Run, settings: Settings
) -> None:
    started = client.post("/v1/transfer-functions?method=filter", content=zipped(scan), headers=ZIP)
    assert started.status_code == 202, started.text
    job = ended(client, started.headers["Location"])
    assert job["state"] == "succeeded", job["error"]
    out = tmp_path / "TF.h5"
    told = run("mtf", scan, "--method", "filter", "--out", out, "--json", "-").json
    # Sums of one BLAS thread and of several differ in their last bits, and so do the ids.
    assert job["result"]["mean_transfer_std"] == pytest.approx(told["mean_transfer_std"], rel=1e-6)
    files = files_of(client, job)
    assert set(files) == {"answer.json", "report.html", "transfer-function.h5"}
    with h5py.File(io.BytesIO(files["transfer-function.h5"])) as theirs, h5py.File(out) as ours:
        assert theirs.attrs["id"] == job["result"]["transfer_function"]
        np.testing.assert_allclose(theirs["transfer"], ours["transfer"], rtol=0.0, atol=1e-9)
    until = time.monotonic() + 60
    while left := list(settings.work_folder.iterdir()):
        assert time.monotonic() < until, left
        time.sleep(0.01)


BAD = {
    "no zip": (b"this is no archive", "not-a-zip", 422),
    "leads up": (packed({"../../mtf.toml": b""}), "unsafe-archive", 422),
    "bomb": (packed({"frames/000.npy": bytes(20 << 20)}), "too-large", 413),
    "no scan": (packed({"readme.txt": b"hello"}), "not-a-scan", 422),
    "two scans": (packed({"a/mtf.toml": b"", "b/mtf.toml": b""}), "not-a-scan", 422),
    "bad toml": (packed({"mtf.toml": b"pitch_um = "}), None, 422),
    "another type": (packed({"mtf.toml": b"pitch_um = 'x'"}), None, 422),
    "nothing": (b"", "empty-body", 422),
}


@pytest.mark.parametrize("case", BAD)
def test_what_is_no_scan_starts_no_job_and_leaves_nothing(
    client: TestClient, settings: Settings, case: str
) -> None:
    body, code, status = BAD[case]
    answer = client.post("/v1/transfer-functions", content=body, headers=ZIP)
    assert answer.status_code == status, answer.text
    assert code in {None, answer.json()["code"]}
    assert str(settings.home) not in answer.text
    assert list(settings.work_folder.iterdir()) == []
    assert client.get("/v1/jobs").json()["items"] == []


def test_a_scan_without_its_frames_fails_by_the_names_of_the_archive(
    scan: Path, tmp_path: Path
) -> None:
    shutil.rmtree(scan / "frames")
    request = {"scan_path": str(scan), "files": str(tmp_path), "method": "filter", "support": 3}
    with pytest.raises(InputError) as refused:
        transfer_function(request, lambda _: None)
    assert str(tmp_path) not in str(refused.value)


def test_a_file_is_found_by_its_name_alone(client: TestClient, settings: Settings) -> None:
    (settings.jobs_folder / "other").mkdir(parents=True)
    (settings.jobs_folder / "secret.json").write_text("{}")
    with Store.open(settings) as store:
        job = store.jobs.submit("diagnose", {}, max_waiting=9)
        store.jobs.finish(job.id, "succeeded", result={})
    folder = settings.jobs_folder / job.id
    folder.mkdir()
    (folder / "answer.json").write_text("{}")
    (folder / "passwd.json").symlink_to("/etc/passwd")
    place = f"/v1/jobs/{job.id}/files"
    assert client.get(f"{place}/answer.json").status_code == 200
    for name in (
        "..%2Fsecret.json",
        "%2e%2e",
        ".",
        "passwd.json",
        "answer",
        "ANSWER.JSON",
        "answer.json%00",
        "%2Fetc%2Fpasswd",
    ):
        assert client.get(f"{place}/{name}").status_code in {404, 307}, name
    assert client.get("/v1/jobs/../files/secret.json").status_code == 404
    assert client.get("/v1/jobs/other/files/secret.json").status_code == 404


def test_a_job_that_is_cancelled_is_killed_and_leaves_nothing(
    client: TestClient, recording_file: Path, settings: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    started: list[Asleep] = []

    class Kept(Asleep):
        def __init__(self, *args: Any) -> None:
            super().__init__(*args)
            started.append(self)

    digest = upload(client, recording_file)
    monkeypatch.setattr("service.api.jobs.runner.JobProcess", Kept)
    place = client.post("/v1/diagnoses", json={"recording": digest}).headers["Location"]
    until = time.monotonic() + 60
    while not started:
        assert time.monotonic() < until
        time.sleep(0.01)
    assert client.post(f"{place}/cancel").json()["state"] == "cancelled"
    started[0]._process.join(60)
    assert started[0]._process.exitcode == -9
    pid = started[0]._process.pid
    assert pid is not None
    with pytest.raises(ProcessLookupError):
        os.kill(pid, 0)
    assert client.get(place).json()["files"] == []


def test_files_of_jobs_that_a_dead_service_left_unfinished_are_removed(settings: Settings) -> None:
    with Store.open(settings) as store:
        jobs = [store.jobs.submit("diagnose", {}, max_waiting=9) for _ in range(2)]
        store.jobs.finish(jobs[0].id, "succeeded", result={})
    for job in jobs:
        (settings.jobs_folder / job.id).mkdir(parents=True)
        (settings.jobs_folder / job.id / "answer.json").write_text("{}")
    with TestClient(create_app(settings), base_url="http://127.0.0.1"):
        assert [path.name for path in settings.jobs_folder.iterdir()] == [jobs[0].id]
