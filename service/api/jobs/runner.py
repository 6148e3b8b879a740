"""Does queued jobs one after the other; the bench computer has other things to do."""

import logging
import queue
import shutil
import threading
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from calib.errors import DarkflatError
from service.api.jobs.files import JobFiles
from service.api.jobs.process import DEFECT, Done, JobProcess
from service.api.jobs.scratch import FILES
from service.store.errors import NotInStoreError
from service.store.jobs import FINAL
from service.store.records import JobRecord
from service.store.store import Store

_LOG = logging.getLogger(__name__)
_TRY_AGAIN_S = 5.0

Finish = Callable[[dict[str, Any]], dict[str, Any]]
"""What is done with a good result, in the server: it may use the store. Returns the answer."""


class JobsStoppedError(DarkflatError):
    """Nothing takes jobs from the queue any more."""


@dataclass(frozen=True)
class _Queued:
    id: str
    kind: str
    request: dict[str, Any]
    finish: Finish
    scratch: Path


class JobRunner:
    """A thread that waits for one process at a time.

    What is on record decides: a job that is final there is not begun, and its result not kept.
    Whoever changes a record and the process together holds the lock.

    Attributes:
        files: What jobs left, also those that failed.
    """

    def __init__(self, store: Store, files: JobFiles, *, max_waiting: int) -> None:
        self.files = files
        self._store = store
        self._max_waiting = max_waiting
        self._queue: queue.SimpleQueue[_Queued | None] = queue.SimpleQueue()
        self._lock = threading.Lock()
        self._running: tuple[str, JobProcess] | None = None
        self._progress: dict[str, float] = {}
        self._closing = False
        self._unrecorded: dict[str, tuple[str, str]] = {}
        self._thread = threading.Thread(target=self._run, name="darkflat-jobs", daemon=True)

    def start(self) -> None:
        """Begin; what an earlier process left behind is marked as interrupted."""
        self._store.jobs.interrupt_all()
        self.files.clear(self._is_done)
        self._thread.start()

    def check_alive(self) -> None:
        """Raise JobsStoppedError `jobs-stopped` where queued jobs would wait for ever."""
        if not self._thread.is_alive():
            msg = "jobs are not done any more; restart the service, its log says why"
            raise JobsStoppedError(msg, code="jobs-stopped")

    def submit(
        self,
        kind: str,
        request: Mapping[str, Any],
        private: Mapping[str, Any],
        finish: Finish,
        *,
        scratch: Path,
    ) -> JobRecord:
        """Queue a job.

        Args:
            kind: One of `work.KINDS`.
            request: What the client asked for; kept on record.
            private: What the work needs to know besides (paths); never shown.
            finish: Called in the server with the work's result.
            scratch: A folder for the work alone, removed however the job ends; what is in its
                folder `files` then is kept unless the job was cancelled.

        Raises:
            StoreError: `too-many-jobs`; the folder is the caller's still.
        """
        record = self._store.jobs.submit(kind, dict(request), max_waiting=self._max_waiting)
        work = {**request, **private, "job": record.id}
        self._queue.put(_Queued(record.id, kind, work, finish, scratch))
        return record

    def progress(self, job_id: str) -> float | None:
        """Return the share that is done of a running job; None of others."""
        return self._progress.get(job_id)

    def cancel(self, job_id: str) -> JobRecord:
        """End a job, whether it waits or runs; one that is done stays as it is."""
        with self._lock:  # waits while a result is kept: then the job has succeeded
            record = self._store.jobs.finish(job_id, "cancelled")
            if self._running is not None and self._running[0] == job_id:
                self._running[1].kill()
        return record

    def close(self) -> None:
        """End the job that runs, forget those that wait; they are marked at the next start."""
        self._queue.put(None)
        with self._lock:
            self._closing = True
            if self._running is not None:
                self._running[1].kill()
        if self._thread.is_alive():
            self._thread.join()
        self._store.jobs.interrupt_all()

    def _run(self) -> None:
        while True:
            try:
                queued = self._queue.get(timeout=_TRY_AGAIN_S if self._unrecorded else None)
            except queue.Empty:
                self._record_failures()
                continue
            if queued is None:
                return
            try:
                self._do(queued)
            except DarkflatError as error:
                self._unrecorded[queued.id] = (error.code, str(error))
            except Exception:
                _LOG.exception("job %s failed", queued.id, extra={"job": queued.id})
                self._unrecorded[queued.id] = DEFECT
            finally:
                shutil.rmtree(queued.scratch, ignore_errors=True)
            self._record_failures()

    def _record_failures(self) -> None:
        """Put on record which jobs failed; while the store refuses, it is tried again later."""
        for job_id, error in tuple(self._unrecorded.items()):
            try:
                self._store.jobs.finish(job_id, "failed", error=error)
            except Exception as refusal:
                _LOG.error(
                    "that it failed cannot be put on record yet: %s", refusal,
                    extra={"job": job_id},
                )  # fmt: skip
            else:
                del self._unrecorded[job_id]

    def _do(self, queued: _Queued) -> None:
        with self._lock:
            if self._closing or not self._store.jobs.start(queued.id):
                return
            process = JobProcess(queued.kind, queued.request)
            self._running = (queued.id, process)
        try:
            done = process.wait(lambda share: self._progress.update({queued.id: share}))
        finally:
            with self._lock:
                self._running = None
            self._progress.pop(queued.id, None)
        self._record(queued, done)

    def _record(self, queued: _Queued, done: Done) -> None:
        with self._lock:
            if self._closing or self._store.jobs.get(queued.id).state in FINAL:
                return
            if done.result is None:
                self.files.keep(queued.id, queued.scratch / FILES)
                self._store.jobs.finish(queued.id, "failed", error=done.error)
                return
            result = queued.finish(done.result)
            self.files.keep(queued.id, queued.scratch / FILES)
            self._store.jobs.finish(queued.id, "succeeded", result=result)

    def _is_done(self, job_id: str) -> bool:
        try:
            return self._store.jobs.get(job_id).state in {"succeeded", "failed"}
        except NotInStoreError:
            return False
