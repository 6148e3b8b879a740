"""Gives the bench to one run after the other, and puts on record what becomes of each."""

import logging
import threading
from pathlib import Path

from calib.errors import DarkflatError
from service.owner.messages import Ended, Measure, Report, Said, Seen
from service.owner.owner import BenchOwner
from service.runs.darkness import Darkness
from service.runs.frames import FrameCount
from service.runs.journal import Journal
from service.runs.news import News
from service.store.actor import Actor
from service.store.errors import StoreError
from service.store.plain_json import plain
from service.store.run_records import RunRecord, RunState
from service.store.store import Store

_LOG = logging.getLogger(__name__)
_TRY_AGAIN_S = 5.0


class RunKeeper:
    """A thread that waits for runs, and one that hears the bench. Thread-safe.

    What is on record decides. Whoever changes a run's record and tells the bench holds the lock.

    Attributes:
        owner: The bench's process; opened and closed by the keeper, where it is not open already.
        news: Wakes who follows.
        frames: How many came since the start.
        darkness: Whether runs wait since safe-off was pressed.
    """

    def __init__(self, store: Store, owner: BenchOwner, folder: Path) -> None:
        """`folder` is where recordings under way are written, one file per run."""
        self.news = News()
        self.frames = FrameCount()
        self.owner = owner
        self.owner.listener = self._hear
        self.darkness = Darkness(store.audit, owner.bench_id)
        self.lock = threading.RLock()
        self._store = store
        self._folder = folder
        self._journal = Journal(store.runs, self.news)
        self._work = threading.Event()
        self._closing = False
        self._thread = threading.Thread(target=self._serve, name="darkflat-runs", daemon=True)

    def start(self) -> None:
        """Mark what a dead service left behind, open the bench, and begin."""
        self._folder.mkdir(parents=True, exist_ok=True)
        self._store.runs.interrupt_all()
        self.owner.open()
        self._thread.start()

    def close(self) -> None:
        """End the run that has the bench, which is marked as interrupted; lamps off."""
        self._closing = True
        self._work.set()
        if self._thread.is_alive():
            self._thread.join()
        self.owner.close()
        self._store.runs.interrupt_all()

    def wake(self) -> None:
        """Look for work now."""
        self._work.set()
        self.news.tell()

    def path_of(self, run_id: str) -> Path:
        """Return where a run records."""
        return self._folder / f"{run_id}.h5"

    def _serve(self) -> None:
        while not self._closing:
            self._work.clear()
            try:
                self._look_for_work()
            except DarkflatError as error:
                _LOG.error("no run can be begun now: %s", error)
            except Exception:
                _LOG.exception("no run can be begun now")
            self._work.wait(_TRY_AGAIN_S)

    def _look_for_work(self) -> None:
        if self.owner.state == "closed":
            self.owner.open()  # it died, or was refused: its lamps are to be switched off
        with self.lock:
            run = self._store.runs.next_queued()
            if run is None or self.owner.state != "idle" or self._closing or self.darkness.kept:
                return
            self._store.runs.move(run.id, "running")
            self._journal.begin()
            self.frames.begin()
            _LOG.info("the run has the bench", extra={"run": run.id})
            try:
                self.owner.measure(Measure(run.id, run.plan, self.path_of(run.id)))
            except DarkflatError as error:
                self._store.runs.move(run.id, "failed", error=(error.code, str(error)))
                _LOG.error("the run cannot be begun: %s", error, extra={"run": run.id})
            if self.darkness.kept:  # since it was looked at: the bench may not know of this run
                self.owner.abort()
        self.news.tell()

    def _hear(self, report: Report) -> None:
        about = {"run": getattr(report, "run_id", "")}
        try:
            match report:
                case Seen():
                    self.news.show(report)
                case Said(run_id, progress):
                    self.frames.take(progress)
                    self._journal.keep(run_id, progress)
                    self._follow(run_id, progress.state)
                case Ended():
                    self._end(report)
                case _:
                    pass
        except StoreError as error:
            _LOG.error("what the bench said cannot be put on record: %s", error, extra=about)
        except Exception:
            _LOG.exception("what the bench said cannot be put on record", extra=about)
        self._work.set()

    def _follow(self, run_id: str, state: str) -> None:
        with self.lock:
            run = self._store.runs.get(run_id)
            if (run.state, state) in {("pausing", "paused"), ("paused", "running")}:
                self._store.runs.move(run_id, "paused" if state == "paused" else "running")
                self.news.tell()

    def _end(self, ended: Ended) -> None:
        with self.lock:
            run = self._store.runs.get(ended.run_id)
            if ended.trouble is not None:
                died = ended.trouble.code == "bench-process-died"
                state: RunState = "interrupted" if died or self._closing else "failed"
                error = (ended.trouble.code, ended.trouble.message)
                self._store.runs.move(run.id, state, error=error)
            elif ended.result is not None and ended.result.state == "succeeded":
                self._keep(run, ended)
            else:
                self._store.runs.move(run.id, "interrupted" if self._closing else "cancelled")
            now = self._store.runs.get(run.id).state
        _LOG.info("the run is %s", now, extra={"run": run.id})
        self.news.tell()

    def _keep(self, run: RunRecord, ended: Ended) -> None:
        """Register what was recorded, then say that it succeeded."""
        from calib.recording.open import open_recording  # noqa: PLC0415  (slow to import)

        assert ended.result is not None  # noqa: S101
        path = self.path_of(run.id)
        kept = self._store.recordings.register(
            open_recording(path),
            name=str(run.plan.get("name", run.id)),
            by=Actor(run.submitted_by),
            digest=ended.digest,
        )
        result = {
            name: value
            for name, value in plain(vars(ended.result)).items()
            if name not in {"state", "path"}
        }
        self._store.runs.move(run.id, "succeeded", result=result, recording_digest=kept.digest)
