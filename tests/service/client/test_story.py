"""A control PC's whole story by REST alone, against a running service and real protocols.

GigE Vision over loopback, lamps, monitor and shutter on pseudo-terminals; 6144 columns.
"""

import importlib.util
import re
from collections.abc import Iterator
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import numpy as np
import pytest
from numpy.typing import NDArray

from calib.forward.model import Model
from calib.radiometric.coefficients.coefficient_set import CoefficientSet
from calib.radiometric.correction.apply import Correction
from service.api.answers.run import EventAnswer
from service.bench.settings import BenchSettings
from service.client import Client, ProblemError
from service.settings import Settings
from service.store.actor import Actor
from service.store.keys import Scope
from service.store.store import Store
from tests.service.client.audit_chain import proven
from tests.service.client.breaking_line import BreakingLine
from tests.service.sequencer.sweep_plans import whole_sweep
from tests.service.sequencer.test_protocols import over_protocols
from tests.service.served import Served, served

pytestmark = [
    pytest.mark.aravis,
    pytest.mark.skipif(importlib.util.find_spec("gi") is None, reason="PyGObject is not there"),
]

MODEL = Model.preset("agcam-nir")
PLAN: dict[str, Any] = whole_sweep(
    MODEL,
    (30.0, 60.0, 90.0),
    (1, 2),
    name="the story",
    lines=64,
    frame_lines=32,
    settle={"tolerance_percent": 5.0, "stable_for_s": 0.2, "interval_s": 0.05, "timeout_s": 20.0},
).model_dump(mode="json")
RADIANCE, EXPOSURE_US = 20.0, 60.0
"""Of the frame that is corrected: inside of what the sweep covers."""


def bench() -> BenchSettings:
    content = over_protocols("story").model_dump()
    content["simulation"] |= {"model": "agcam-nir", "lamps": 2}
    return BenchSettings.parse(content)


@pytest.fixture
def service(tmp_path: Path) -> Iterator[Served]:
    with served(tmp_path, bench()) as started:
        yield started


@pytest.fixture
def key(service: Served) -> str:
    with Store.open(Settings(home=service.home)) as store:
        return store.keys.create("control-pc", Scope.CERTIFY, expires_at=None, by=Actor("root"))[1]


def a_frame() -> NDArray[np.uint8]:
    """Draw 714 lines of 6144 columns of one radiance, without the program's own chain."""
    truth, rng = MODEL.truth(), np.random.default_rng()
    gain = truth.system_gain_dn_per_e
    signal_dn = RADIANCE * truth.vignette * truth.responsivity * EXPOSURE_US
    photoelectrons = rng.poisson(signal_dn / gain, (714, 6144))
    electrons = photoelectrons + rng.normal(0.0, truth.read_noise_e, photoelectrons.shape)
    return np.clip(np.rint(electrons * gain + truth.dark_offset_dn), 0, 255).astype(np.uint8)


def test_a_control_pc_calibrates_by_rest_alone(service: Served, key: str, tmp_path: Path) -> None:
    with service.client(key=key) as client:
        planned = client.runs.validate(PLAN)
        assert len(planned.steps) == 9
        assert list(client.runs.all()) == []
        run = client.runs.start(PLAN, idempotency_key="nightly")
        assert client.runs.start(PLAN, idempotency_key="nightly").id == run.id
        events = followed_over_a_broken_line(service, key, client, run.id)
        assert_whole(events)
        recording = client.runs.wait(run.id).recording
        assert recording is not None
        set_id = calibrated_and_certified(client, recording)
        assert_found_by_camera_and_time(client, set_id)
        assert_applied(client, set_id, tmp_path)
        assert_audited(client, run.id, set_id)


def followed_over_a_broken_line(
    service: Served, key: str, client: Client, run_id: str
) -> list[EventAnswer]:
    """Follow a run; lose the connection, pause it, look at the lamps, let it go on."""
    events: list[EventAnswer] = []
    port = urlsplit(service.url).port
    assert port is not None
    with BreakingLine(port) as line, Client(line.url, key=key, patience_s=60) as far:
        cut_at = None
        for event in far.runs.follow(run_id):
            events.append(event)
            done = event.content.get("blocks_done")
            if done == 2 and cut_at is None:
                cut_at = event.number
                line.cut()
            if done == 4 and not paused(events):
                client.runs.pause(run_id)
            if event.content.get("state") == "paused":
                light = next(each for each in client.bench.look() if each.role == "light")
                assert light.values["level"] == 0.0
                client.runs.resume(run_id)
        assert cut_at is not None
        asked = re.findall(r"last-event-id: (\d+)", "".join(line.heads), re.IGNORECASE)
        assert [int(number) >= cut_at for number in asked] == [False, True]
    return events


def paused(events: list[EventAnswer]) -> bool:
    return any(event.content.get("state") == "pausing" for event in events)


def assert_whole(events: list[EventAnswer]) -> None:
    assert [event.number for event in events] == list(range(1, len(events) + 1))
    assert [event.content["state"] for event in events if event.kind == "state"] == [
        "queued", "running", "pausing", "paused", "running", "succeeded",
    ]  # fmt: skip


def calibrated_and_certified(client: Client, recording: str) -> str:
    shares: list[float] = []
    job = client.jobs.wait(client.jobs.calibrate(recording).id, on_progress=shares.append)
    assert shares == sorted(shares)
    assert job.result is not None
    set_id: str = job.result["coefficient_set"]
    assert client.coefficient_sets.verify(set_id, reason="curves look right").state == "verified"
    now = datetime.now(UTC)
    made = client.coefficient_sets.certify(set_id, valid_from=now, reason="first calibration")
    assert made.certification is not None
    return set_id


def assert_found_by_camera_and_time(client: Client, set_id: str) -> None:
    setting: dict[str, Any] = {"serial": "AGCAM-NIR", "band": "NIR", "bit_depth": 8}
    found = client.coefficient_sets.lookup(**setting, at=datetime.now(UTC))
    assert (found.id, found.state) == (set_id, "certified")
    with pytest.raises(ProblemError) as refused:
        client.coefficient_sets.lookup(**setting, at=datetime.now(UTC) - timedelta(days=1))
    assert (refused.value.status, refused.value.code) == (404, "not-found")


def assert_applied(client: Client, set_id: str, folder: Path) -> None:
    """The radiance is that of the set, and the frame's own within its stated uncertainty."""
    frame = a_frame()
    applied = client.coefficient_sets.apply(
        set_id, frame, exposure_us=EXPOSURE_US, serial="AGCAM-NIR", band="NIR", bit_depth=8,
        at=datetime.now(UTC),
    )  # fmt: skip
    file = client.coefficient_sets.download(set_id, folder / "set.h5")
    coefficients = CoefficientSet.load(file)
    expected = Correction(coefficients, EXPOSURE_US, camera=coefficients.camera).lines(frame)
    np.testing.assert_array_equal(applied.radiance, expected.radiance)
    np.testing.assert_array_equal(applied.flags, expected.flags)
    assert applied.radiance.shape == (714, 6144)
    z = (applied.radiance.astype(np.float64) - RADIANCE) / applied.std
    # The stated noise is as uncertain as the system gain that it goes with, at most by half;
    # beside that 4.4 million samples, and 6144 columns whose own errors are a tenth of the noise.
    gain = coefficients.system_gain_dn_per_e_std / coefficients.system_gain_dn_per_e
    allowed = 5 * np.hypot(0.5 * gain, 1 / np.sqrt(2 * z.size)) + 5 * 0.01 / np.sqrt(2 * 6144)
    assert abs(np.sqrt(np.mean(z**2)) - 1) < allowed


def assert_audited(client: Client, run_id: str, set_id: str) -> None:
    entries = list(client.audit.all())[::-1]
    assert [each.digest for each in entries] == proven(entries)
    proof = client.audit.verify()
    assert (proof.entries, proof.digest) == (len(entries), entries[-1].digest)
    by_us = [(each.action, each.subject) for each in entries if each.who == "control-pc"]
    assert by_us == [
        ("run.submit", run_id), ("run.pausing", run_id), ("run.running", run_id),
        ("recording.register", client.runs.get(run_id).recording),
        ("coefficient-set.draft", set_id), ("coefficient-set.verified", set_id),
        ("coefficient-set.certified", set_id),
    ]  # fmt: skip
