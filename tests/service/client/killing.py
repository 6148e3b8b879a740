"""A service that is killed again and again while it runs a plan, certifies and takes uploads."""

import os
import random
import signal
import threading
import time
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from statistics import median
from typing import Any

from calib.recording.commit_log import commit_path
from calib.recording.open import open_recording
from service.client import Client
from service.client.runs import FINAL
from service.plan.expand import expand
from service.plan.model import Plan
from service.settings import Settings
from service.store.check.check import check
from tests.service.api.packing import as_folder
from tests.service.client.clients_at_work import Acknowledged, ClientsAtWork
from tests.service.client.darkness import is_dark, wait_until
from tests.service.sequencer.benches import short_plan, whole_blocks
from tests.service.sequencer.test_kill import assert_survived
from tests.service.served import Served, children, until_idle

EXPOSURES_US = (50.0, 100.0, 150.0)


def plan_of(exposures_us: Sequence[float]) -> Plan:
    """Return a plan of a dark and a flat of 0.8 s at each exposure."""
    return short_plan(
        sweep={"type": "exposure", "exposures_us": list(exposures_us), "level": 2},
        lines=768,
        settle={
            "tolerance_percent": 5.0, "stable_for_s": 0.1, "interval_s": 0.02, "timeout_s": 60.0
        },
    )  # fmt: skip


class Killing:
    """Kills, starts anew, and looks at what is there.

    Attributes:
        plan: Of the run.
        told: What was acknowledged.
        cut: How many kills came in the middle of a run, a certification, an upload.
        dark_after_s: How long after a restart had begun the lamps were seen to be off, where the
            bench's process died with the service and they burnt until then.
        dark_alone_after_s: Likewise after a kill of the service alone.
    """

    def __init__(
        self,
        service: Served,
        folder: Path,
        recording: Path,
        exposures_us: Sequence[float] = EXPOSURES_US,
    ) -> None:
        self.service = service
        self.plan = plan_of(exposures_us)
        self.told = Acknowledged()
        self.cut: Counter[str] = Counter()
        self.dark_after_s: list[float] = []
        self.dark_alone_after_s: list[float] = []
        self._folder = folder
        self._archive = as_folder(recording, folder)
        self._run_id = ""
        self._frames: list[bytes] = []
        self._random = random.Random()

    def once(self, *, bench_too: bool) -> None:
        """Let clients work, kill at a random moment of all that goes on, start anew and look."""
        self._begin()
        clients = ClientsAtWork(self.service, self._archive, self._folder, self.told)
        with clients:
            wait_until(self._is_lit_or_over)
            wait_until(lambda: bool(self.told.recordings and self.told.certified))
            time.sleep(self._random.uniform(0.0, 1.5))
            doomed = children(self.service.pid) if bench_too else []
            clients.certifying.clear()
            assert clients.certifying.wait(60)
            time.sleep(self._random.uniform(0.0, self.told.certifying_s))
            killed_at_s = self._kill(doomed)
        self.cut.update(what for what, at in clients.asked_at_s.items() if at < killed_at_s)
        before = self.acknowledged_frames()
        assert before[: len(self._frames)] == self._frames
        self._frames = before
        self._restart(bench_too=bench_too)
        self._look()

    def _begin(self) -> None:
        with self.service.client() as client:
            if self._run_id and client.runs.get(self._run_id).state == "interrupted":
                client.runs.resume(self._run_id)
                return
            self._run_id = client.runs.start(self.plan.model_dump(mode="json")).id
            self._frames = []

    def _is_lit_or_over(self) -> bool:
        """A run that was killed after its last block has no lamp to light any more."""
        if not self._is_dark():
            return True
        with self.service.client() as client:
            return client.runs.get(self._run_id).state in FINAL

    def _is_dark(self) -> bool:
        return is_dark(self._folder / "world")

    def _kill(self, children_too: list[int]) -> float:
        """kill -9, the bench's process first: once the service is dead it switches off."""
        at_s = time.monotonic()
        for pid in children_too:
            os.kill(pid, signal.SIGKILL)
        self.service.kill()
        return at_s

    def _restart(self, *, bench_too: bool) -> None:
        burns, began_s = not self._is_dark(), time.monotonic()
        took_s: list[float] = []

        def watch() -> None:
            wait_until(self._is_dark, every_s=0.002)
            took_s.append(time.monotonic() - began_s)

        watching = threading.Thread(target=watch)
        watching.start()
        self.service.start()
        watching.join()
        if not bench_too:
            self.dark_alone_after_s += took_s
        elif burns:
            self.dark_after_s += took_s

    def _look(self) -> None:
        with self.service.client() as client:
            until_idle(client)
            light = next(each for each in client.bench.look() if each.role == "light")
            assert light.values["level"] == 0.0, light
            run = client.runs.get(self._run_id)
            assert run.state in {"interrupted", "succeeded"}, run.error
            self.cut["run"] += run.state == "interrupted"
            self._assert_kept(client)
        checked = check(Settings(home=self.service.home), lambda *_: None)
        assert checked.findings == ()

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
            run = client.runs.wait(self._run_id)  # raises unless it succeeded
            assert client.recordings.get(run.recording or "").digest == run.recording
        assert_survived(self._frames, self.acknowledged_frames())
        lines: dict[str, Any] = {step.block.block: step.lines for step in expand(self.plan)}
        assert whole_blocks(self._recorded()) == lines

    def in_words(self) -> str:
        """Return the figures."""
        told = self.told
        return (
            f"in the middle of {dict(self.cut)}; {len(told.recordings)} uploads and"
            f" {len(told.certified)} certifications acknowledged; after the restart dark, both"
            f" processes killed: {_in_words(self.dark_after_s)}; the service alone:"
            f" {_in_words(self.dark_alone_after_s)}"
        )

    def acknowledged_frames(self) -> list[bytes]:
        """Return the whole lines of the run's commit record."""
        path = commit_path(self._recorded())
        return path.read_bytes().split(b"\n")[:-1] if path.exists() else []

    def _recorded(self) -> Path:
        return self.service.home / "runs" / f"{self._run_id}.h5"


def _in_words(seconds: list[float]) -> str:
    each = " ".join(f"{second:.3f}" for second in sorted(seconds))
    return f"median {median(seconds):.3f} s, at most {max(seconds):.3f} s ({each})"
