"""Jobs by the client: begun, waited for with their progress, cancelled, their files fetched.

What the work itself answers is tried in tests/service/api; here it is done at once, in this
process.
"""

import threading
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import pytest

from calib.errors import InputError
from calib.recording.open import open_recording
from calib.recording.tone import Tone
from service.api.answers.job import JobAnswer
from service.api.jobs.process import Done
from service.client import Client, ProblemError, WorkFailedError
from service.settings import Settings
from tests.service.store.a_store import a_set

UNTIL_S = 60.0


class Work:
    """In place of a process: is half done until its client has heard of it, then leaves a file."""

    heard: threading.Event
    requests: dict[str, Mapping[str, Any]]

    def __init__(self, kind: str, request: Mapping[str, Any]) -> None:
        self.requests[kind] = self._request = request
        self._heard, self._killed = self.heard, False

    def wait(self, tell: Callable[[float], None]) -> Done:
        tell(0.5)
        assert self._heard.wait(UNTIL_S)
        if self._killed:
            return Done(error=("worker-died", ""))
        (Path(self._request["files"]) / "answer.json").write_text("{}")
        (Path(self._request["files"]) / "report.html").write_text("<p>")
        if "out_path" in self._request:
            a_set().save(Path(self._request["out_path"]))
        return Done(result={"coefficient_set": a_set().id})

    def kill(self) -> None:
        self._killed = True
        self._heard.set()


@pytest.fixture
def store_url(url: str) -> str:
    """Each test on SQLite and on PostgreSQL."""
    return url


@pytest.fixture
def work(client: Client, monkeypatch: pytest.MonkeyPatch) -> type[Work]:
    monkeypatch.setattr(Work, "heard", threading.Event(), raising=False)
    monkeypatch.setattr(Work, "requests", {}, raising=False)
    monkeypatch.setattr("service.api.jobs.runner.JobProcess", Work)
    return Work


@pytest.fixture
def digest(client: Client, recording_file: Path) -> str:
    return client.recordings.upload(recording_file).digest


@pytest.fixture
def scan(tmp_path: Path) -> Path:
    folder = tmp_path / "scan"
    folder.mkdir()
    (folder / "mtf.toml").write_text(
        "pitch_um = 25.0\n[grating]\neta2 = 650\nperiod_um = 500.0\n[scan]\nm = 1\nn = 6\n"
    )
    return folder


BEGIN: dict[str, tuple[Callable[[Client, str, Path], JobAnswer], dict[str, Any]]] = {
    "calibrate": (
        lambda client, digest, _: client.jobs.calibrate(
            digest, radiances={2: 20.1, 4: 40.2}, order=4, tone=Tone(0.1, 300.0)
        ),
        {
            "radiances": {"2.0": 20.1, "4.0": 40.2}, "order": 4, "relative": False,
            "tone": {"cycles_per_pixel": 0.1, "pixels_per_line": 300.0},
        },
    ),
    "photon-transfer": (
        lambda client, digest, _: client.jobs.photon_transfer(digest, method="sanuc"),
        {"method": "sanuc"},
    ),
    "diagnose": (
        lambda client, digest, _: client.jobs.diagnose(digest, second_recording=digest),
        {"model": None},
    ),
    "transfer-function": (
        lambda client, _, scan: client.jobs.transfer_function(scan, method="filter", support=5),
        {"method": "filter", "support": 5},
    ),
}  # fmt: skip


@pytest.mark.parametrize("kind", BEGIN)
def test_a_job_of_any_kind_is_waited_for_and_its_files_fetched(
    *, client: Client, work: type[Work], digest: str, scan: Path, tmp_path: Path, kind: str
) -> None:
    begin, wanted = BEGIN[kind]
    begun = begin(client, digest, scan)
    assert begun.kind == kind
    shares: list[float] = []

    def hear(share: float) -> None:
        shares.append(share)
        work.heard.set()

    job = client.jobs.wait(begun.id, on_progress=hear, every_s=0.005)
    assert (job.state, shares) == ("succeeded", [0.5])
    assert {name: work.requests[kind][name] for name in wanted} == wanted
    assert {name: job.request[name] for name in wanted} == wanted
    folder = tmp_path / "fetched"
    folder.mkdir()
    fetched = client.jobs.download_all(job.id, folder)
    assert [(path.name, path.read_text()) for path in fetched] == [
        ("answer.json", "{}"), ("report.html", "<p>"),
    ]  # fmt: skip
    one = client.jobs.download(job.id, "answer.json", tmp_path / "mine.json")
    assert one.read_text() == "{}"
    assert [each.id for each in client.jobs.all()] == [job.id]
    is_made = kind == "calibrate"
    assert [each.id for each in client.coefficient_sets.all()] == [a_set().id] * is_made


def test_a_job_that_is_cancelled_is_waited_for_in_vain(
    client: Client, work: type[Work], digest: str, settings: Settings
) -> None:
    job = client.jobs.diagnose(digest)
    assert client.jobs.cancel(job.id).state == "cancelled"
    with pytest.raises(WorkFailedError) as failed:
        client.jobs.wait(job.id)
    assert (failed.value.code, failed.value.state) == ("job-cancelled", "cancelled")
    assert client.jobs.cancel(job.id).state == "cancelled"
    with pytest.raises(ProblemError) as refused:
        client.jobs.download(job.id, "answer.json", settings.home / "answer.json")
    assert refused.value.code == "not-found"
    assert not (settings.home / "answer.json").exists()


def test_a_recording_that_a_job_needs_stays_and_then_goes(
    client: Client, work: type[Work], digest: str, tmp_path: Path
) -> None:
    job = client.jobs.photon_transfer(digest)
    with pytest.raises(ProblemError) as refused:
        client.recordings.delete(digest)
    assert refused.value.code == "recording-in-use"
    out = client.recordings.download(digest, tmp_path / "recording.zip")
    client.jobs.cancel(job.id)
    client.recordings.delete(digest)
    with pytest.raises(ProblemError):
        client.recordings.get(digest)
    assert client.recordings.upload(out, name="again").digest == digest


def test_what_is_no_scan_is_not_sent(client: Client, tmp_path: Path) -> None:
    with pytest.raises(InputError) as refused:
        client.jobs.transfer_function(tmp_path)
    assert refused.value.code == "not-a-scan"


def test_a_recording_is_inspected(client: Client, digest: str, recording_file: Path) -> None:
    header = client.recordings.get(digest).header
    assert header["camera"]["serial"] == open_recording(recording_file).header.camera.serial
