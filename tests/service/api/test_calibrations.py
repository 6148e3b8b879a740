"""A calibration as a job: from an uploaded recording to a draft."""

import time
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient

from calib.errors import DarkflatError
from calib.forward.effects.nonlinearity import Nonlinearity
from calib.forward.model import Model
from calib.radiometric.calibrate import calibrate
from calib.recording.open import open_recording
from calib.recording.tone import Tone
from service.api.jobs.process import Done, JobProcess
from service.cli.simulated_recording import simulate_recording
from service.plan.model import Plan
from tests.service.api.packing import as_files
from tests.service.cli.a_recording import PLAN

PLACE = "/v1/calibrations"
ZIP = {"Content-Type": "application/zip"}


@pytest.fixture
def digest(client: TestClient, recording_file: Path) -> str:
    answer = client.post(
        "/v1/recordings",
        content=as_files(recording_file),
        headers=ZIP,
    )
    return str(answer.json()["digest"])


def ended(client: TestClient, place: str) -> dict[str, Any]:
    until = time.monotonic() + 240  # a job is polite: a busy machine keeps it waiting
    while True:
        job: dict[str, Any] = client.get(place).json()
        if job["state"] not in {"queued", "running"}:
            return job
        assert time.monotonic() < until
        time.sleep(0.05)


@pytest.mark.usefixtures("here_and_now")
def test_what_cannot_be_calibrated_fails_with_the_sentence_of_the_calibration(
    client: TestClient, tmp_path: Path
) -> None:
    plan = Plan.loads(PLAN.replace("10.0, 40.0, 90.0", "40.0"))
    one_exposure = tmp_path / "one.h5"
    simulate_recording(Model.preset("demo"), plan, one_exposure, seed=1, scenes_folder=tmp_path)
    with pytest.raises(DarkflatError) as refused:
        calibrate(open_recording(one_exposure))
    answer = client.post("/v1/recordings", content=as_files(one_exposure), headers=ZIP)
    started = client.post(PLACE, json={"recording": answer.json()["digest"]})
    job = ended(client, started.headers["Location"])
    assert job["state"] == "failed"
    assert job["error"]["code"] == refused.value.code
    assert client.get("/v1/coefficient-sets").json()["items"] == []


@pytest.mark.parametrize(
    "wrong",
    [
        {"radiances": {"2": -1.0}},
        {"order": 99},
        {"ordre": 4},
        {"tone": {"cycles_per_pixel": 0.1}},
        {"recording": 5},
    ],
)
def test_a_request_with_a_mistake_starts_no_job(
    client: TestClient, digest: str, wrong: dict[str, Any]
) -> None:
    answer = client.post(PLACE, json={"recording": digest, **wrong})
    assert (answer.status_code, answer.json()["code"]) == (422, "invalid-request")
    assert client.get("/v1/jobs").json()["items"] == []


def test_a_tone_that_cannot_be_starts_no_job(client: TestClient, digest: str) -> None:
    tone = {"cycles_per_pixel": 0.7, "pixels_per_line": 300.0}
    answer = client.post(PLACE, json={"recording": digest, "tone": tone})
    assert (answer.status_code, answer.json()["code"]) == (422, "tone-invalid")
    assert client.get("/v1/jobs").json()["items"] == []


@pytest.mark.usefixtures("here_and_now")
def test_a_tone_is_removed_as_on_the_command_line(
    client: TestClient, digest: str, recording_file: Path
) -> None:
    tone = {"cycles_per_pixel": 0.123, "pixels_per_line": 300.0}
    expected, other = (
        calibrate(open_recording(recording_file), tone=each).answer()
        for each in (Tone(0.123, 300.0), None)
    )
    at_axis = expected["responsivity_at_axis"]["value"]
    assert at_axis != other["responsivity_at_axis"]["value"]
    started = client.post(PLACE, json={"recording": digest, "tone": tone})
    job = ended(client, started.headers["Location"])
    assert job["state"] == "succeeded", job["error"]
    assert job["result"]["responsivity_at_axis"]["value"] == pytest.approx(at_axis, rel=1e-9)
    assert job["request"]["tone"] == tone


@pytest.mark.usefixtures("here_and_now")
def test_a_models_departures_are_taken_out_as_on_the_command_line(
    client: TestClient, digest: str, recording_file: Path
) -> None:
    recorded = open_recording(recording_file)
    links = Model.preset("demo").with_effect(Nonlinearity(1e-5)).effects
    model = Model(recorded.header.camera, recorded.header.source, links)
    started = client.post(PLACE, json={"recording": digest, "model": model.dumps()})
    job = ended(client, started.headers["Location"])
    assert job["state"] == "succeeded", job["error"]
    at_axis, plain = (
        calibrate(recorded, model=m).answer()["responsivity_at_axis"]["value"]
        for m in (model, None)
    )
    assert at_axis != pytest.approx(plain, rel=1e-4)
    found = job["result"]["responsivity_at_axis"]["value"]
    assert found == pytest.approx(at_axis, rel=1e-9)  # another process, the same steps
    assert list(job["result"]["departures"]) == ["nonlinearity"]


def test_a_model_that_cannot_be_starts_no_job(client: TestClient, digest: str) -> None:
    answer = client.post(PLACE, json={"recording": digest, "model": "[effects.lagg]"})
    assert answer.status_code == 422
    assert client.get("/v1/jobs").json()["items"] == []


def test_a_worker_that_dies_is_no_silence(tmp_path: Path) -> None:
    process = JobProcess("calibrate", {"radiances": None, "recording_path": str(tmp_path)})
    process.kill()
    done = process.wait(lambda _: None)
    assert isinstance(done, Done)
    assert done.error is not None
    assert done.error[0] == "worker-died"
