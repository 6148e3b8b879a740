"""`kill -9` of the server while it runs a plan, certifies and takes uploads: nothing is lost.

Every other time the bench's process dies with it, as when the power fails for both.
"""

import os
import random
import signal
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from calib.recording.commit_log import commit_path
from calib.recording.open import open_recording
from service.bench.settings import BenchSettings
from service.client import Client
from service.plan.expand import expand
from service.plan.model import Plan
from tests.service.api.packing import as_folder
from tests.service.cli.a_recording import plan_file, recording_file
from tests.service.client.clients_at_work import Acknowledged, ClientsAtWork
from tests.service.client.darkness import is_dark, wait_until
from tests.service.sequencer.benches import in_process, short_plan, whole_blocks
from tests.service.sequencer.test_kill import assert_survived
from tests.service.served import Served, served, until_idle

__all__ = ["plan_file", "recording_file"]

DARK_WITHIN_S = 5.0
"""Of the restart: the promise, which the long form measures."""
PLAN: Plan = short_plan(
    sweep={"type": "exposure", "exposures_us": [50.0, 100.0, 150.0], "level": 2}, lines=768
)


@pytest.fixture
def service(tmp_path: Path) -> Iterator[Served]:
    content = in_process(f"server-{os.getpid()}", tmp_path / "world").model_dump()
    content["camera"]["paced"] = True  # 768 lines of 1 ms: frames come all the time
    with served(tmp_path, BenchSettings.parse(content)) as started:
        yield started


def children(pid: int) -> list[int]:
    return [int(each) for each in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]


class Killing:
    """A service with work to do, killed again and again.

    Attributes:
        told: What was acknowledged.
        dark_after_s: How long after each restart had begun the lamps were seen to be off.
        states: Of the run, as found after each restart.
    """

    def __init__(self, service: Served, folder: Path, recording: Path) -> None:
        self.service = service
        self.told = Acknowledged()
        self.dark_after_s: list[float] = []
        self.states: list[str] = []
        self._folder = folder
        self._archive = as_folder(recording, folder)
        self._run_id = ""
        self._frames: list[bytes] = []

    def once(self, delay_s: float, *, bench_too: bool) -> None:
        """Let clients work, kill the service `delay_s` after a lamp burns, and look."""
        self._begin()
        with ClientsAtWork(self.service, self._archive, self._folder, self.told):
            wait_until(self._is_lit_or_over)
            wait_until(lambda: bool(self.told.recordings and self.told.certified))
            time.sleep(delay_s)
            others = children(self.service.pid) if bench_too else []
            self.service.kill()
            for pid in others:
                os.kill(pid, signal.SIGKILL)
        before = self.acknowledged_frames()
        assert before[: len(self._frames)] == self._frames
        self._frames = before
        self._restart()
        self._look()

    def _begin(self) -> None:
        with self.service.client() as client:
            if self._run_id and client.runs.get(self._run_id).state == "interrupted":
                client.runs.resume(self._run_id)
                return
            self._run_id = client.runs.start(PLAN.model_dump(mode="json")).id
            self._frames = []

    def _is_lit_or_over(self) -> bool:
        """A run that was killed after its last block has no lamp to light any more."""
        if not is_dark(self._folder / "world"):
            return True
        with self.service.client() as client:
            return client.runs.get(self._run_id).state == "succeeded"

    def _restart(self) -> None:
        began_s = time.monotonic()

        def watch() -> None:
            wait_until(lambda: is_dark(self._folder / "world"))
            self.dark_after_s.append(time.monotonic() - began_s)

        watching = threading.Thread(target=watch)
        watching.start()
        self.service.start()
        watching.join()

    def _look(self) -> None:
        with self.service.client() as client:
            until_idle(client)
            light = next(each for each in client.bench.look() if each.role == "light")
            assert light.values["level"] == 0.0
            self.states.append(client.runs.get(self._run_id).state)
            assert self.states[-1] in {"interrupted", "succeeded"}
            self._assert_kept(client)

    def _assert_kept(self, client: Client) -> None:
        """What was acknowledged is there, whole, and in a log that is whole."""
        for digest in self.told.recordings:
            assert client.recordings.get(digest).digest == digest
            kept = self.service.home / "recordings" / digest / "recording.h5"
            assert open_recording(kept).digest() == digest
        entries: dict[str, list[str]] = {}
        for entry in client.audit.all():
            entries.setdefault(entry.subject, []).append(entry.action)
        assert client.audit.verify().entries == sum(map(len, entries.values()))
        for set_id in self.told.verified:
            assert client.coefficient_sets.get(set_id).state in {"verified", "certified"}
            assert "coefficient-set.verified" in entries[set_id]
        for set_id in self.told.certified:
            assert client.coefficient_sets.get(set_id).state == "certified"
            assert "coefficient-set.certified" in entries[set_id]

    def finish(self) -> None:
        """Let the run come to its end: it is what it would have been, frame by frame."""
        with self.service.client() as client:
            if client.runs.get(self._run_id).state == "interrupted":
                client.runs.resume(self._run_id)
            run = client.runs.wait(self._run_id)
            assert client.recordings.get(run.recording or "").digest == run.recording
        assert_survived(self._frames, self.acknowledged_frames())
        lines: dict[str, Any] = {step.block.block: step.lines for step in expand(PLAN)}
        assert whole_blocks(self._recorded()) == lines

    def acknowledged_frames(self) -> list[bytes]:
        """Return the whole lines of the run's commit record."""
        path = commit_path(self._recorded())
        return path.read_bytes().split(b"\n")[:-1] if path.exists() else []

    def _recorded(self) -> Path:
        return self.service.home / "runs" / f"{self._run_id}.h5"


def kill(service: Served, folder: Path, recording: Path, kills: int) -> Killing:
    killing, rng = Killing(service, folder, recording), random.Random()
    for n in range(kills):
        killing.once(rng.uniform(0.0, 1.5), bench_too=n % 2 == 1)
    killing.finish()
    assert killing.told.recordings
    assert killing.told.certified
    assert "interrupted" in killing.states
    return killing


def test_a_killed_server_has_lost_nothing_that_it_acknowledged(
    service: Served, tmp_path: Path, recording_file: Path
) -> None:
    kill(service, tmp_path, recording_file, kills=2)


@pytest.mark.soak
def test_twenty_kills_lose_nothing_and_the_lamps_are_off_within_five_seconds(
    service: Served, tmp_path: Path, recording_file: Path
) -> None:
    killing = kill(service, tmp_path, recording_file, kills=20)
    told = killing.told
    print(  # noqa: T201  shown by pytest -rP
        f"{len(told.recordings)} uploads, {len(told.certified)} certifications; dark after",
        [round(each, 2) for each in killing.dark_after_s], killing.states,
    )  # fmt: skip
    assert max(killing.dark_after_s) < DARK_WITHIN_S
