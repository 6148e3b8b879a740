"""Does queued jobs one after the other; the bench computer has other things to do."""

import logging
import queue
import threading
from collections.abc import Callable, Mapping
from typing import Any

from calib.errors import DarkflatError
from service.api.jobs.process import Done, JobProcess
from service.store.jobs import FINAL
from service.store.records import JobRecord
from service.store.store import Store

_LOG = logging.getLogger(__name__)

Finish = Callable[[dict[str, Any]], dict[str, Any]]
"""What is done with a good result, in the server: it may use the store. Returns the answer."""


class JobRunner:
    """A thread that waits for one process at a time."""

    def __init__(self, store: Store, *, max_waiting: int) -> None:
        self._store = store
        self._max_waiting = max_waiting
        self._queue: queue.SimpleQueue[tuple[str, str, dict[str, Any], Finish] | None] = (
            queue.SimpleQueue()
        )
        self._lock = threading.Lock()
        self._running: tuple[str, JobProcess] | None = None
        self._progress: dict[str, float] = {}
        self._cancelled: set[str] = set()
        self._thread = threading.Thread(target=self._run, name="darkflat-jobs", daemon=True)

    def start(self) -> None:
        """Begin; what an earlier process left behind is marked as interrupted."""
        self._store.jobs.interrupt_all()
        self._thread.start()

    def submit(
        self, kind: str, request: Mapping[str, Any], private: Mapping[str, Any], finish: Finish
    ) -> JobRecord:
        """Queue a job.

        Args:
            kind: One of `work.KINDS`.
            request: What the client asked for; kept on record.
            private: What the work needs to know besides (paths); never shown.
            finish: Called in the server with the work's result.

        Raises:
            StoreError: `too-many-jobs`.
        """
        record = self._store.jobs.submit(kind, dict(request), max_waiting=self._max_waiting)
        self._queue.put((record.id, kind, {**request, **private}, finish))
        return record

    def progress(self, job_id: str) -> float | None:
        """Return the share that is done of a running job; None of others."""
        return self._progress.get(job_id)

    def cancel(self, job_id: str) -> JobRecord:
        """End a job, whether it waits or runs; one that is done stays as it is."""
        record = self._store.jobs.get(job_id)
        if record.state in FINAL:
            return record
        with self._lock:
            self._cancelled.add(job_id)
            if self._running is not None and self._running[0] == job_id:
                self._running[1].kill()
        return self._store.jobs.finish(job_id, "cancelled")

    def close(self) -> None:
        """End the job that runs, forget those that wait; they are marked at the next start."""
        self._queue.put(None)
        with self._lock:
            self._cancelled.add("*")
            if self._running is not None:
                self._running[1].kill()
        if self._thread.is_alive():
            self._thread.join()
        self._store.jobs.interrupt_all()

    def _run(self) -> None:
        while (queued := self._queue.get()) is not None:
            job_id, kind, request, finish = queued
            try:
                if not self._is_cancelled(job_id) and self._store.jobs.start(job_id):
                    self._do(job_id, kind, request, finish)
            except Exception:
                _LOG.exception("job %s failed", job_id)
                error = ("internal-error", "a defect in darkflat; its log says more")
                self._store.jobs.finish(job_id, "failed", error=error)

    def _is_cancelled(self, job_id: str) -> bool:
        return not self._cancelled.isdisjoint({job_id, "*"})

    def _do(self, job_id: str, kind: str, request: dict[str, Any], finish: Finish) -> None:
        with self._lock:
            if self._is_cancelled(job_id):
                return
            process = JobProcess(kind, request)
            self._running = (job_id, process)
        try:
            done = process.wait(lambda share: self._progress.update({job_id: share}))
        finally:
            with self._lock:
                self._running = None
            self._progress.pop(job_id, None)
        if self._is_cancelled(job_id):
            return
        self._record(job_id, done, finish)

    def _record(self, job_id: str, done: Done, finish: Finish) -> None:
        if done.result is None:
            self._store.jobs.finish(job_id, "failed", error=done.error)
            return
        try:
            result = finish(done.result)
        except DarkflatError as error:
            self._store.jobs.finish(job_id, "failed", error=(error.code, str(error)))
        else:
            self._store.jobs.finish(job_id, "succeeded", result=result)
