"""What clients may ask of runs; each command is idempotent, and none is a toggle."""

import logging

from service.owner.messages import BenchLook
from service.plan.expand import expand
from service.plan.model import Plan
from service.runs.errors import BenchHeldError
from service.runs.keeper import RunKeeper
from service.store.actor import Actor
from service.store.run_records import FINAL, RunRecord
from service.store.store import Store

_LOG = logging.getLogger(__name__)


class RunCommands:
    """Thread-safe. Whoever did not submit a run may not move it: safe-off is for everybody."""

    def __init__(self, store: Store, keeper: RunKeeper) -> None:
        self._store = store
        self._keeper = keeper

    def submit(
        self, plan: Plan, by: Actor, *, idempotency_key: str | None
    ) -> tuple[RunRecord, bool]:
        """Queue a run; return it and whether it is new. A new one releases a bench kept dark."""
        found = self._store.runs.submit(
            plan.model_dump(mode="json"),
            plan.digest(),
            blocks_total=len(expand(plan)),
            by=by,
            idempotency_key=idempotency_key,
        )
        _log("submitted", found[0].id, by)
        if found[1]:
            self._keeper.darkness.end(by)
        self._keeper.wake()
        return found

    def pause(self, run_id: str, by: Actor) -> RunRecord:
        """Hold a run; its lamps are then as its plan says."""
        with self._keeper.lock:
            run = self._own(run_id, by)
            if run.state in {"pausing", "paused"}:
                return run
            run = self._store.runs.move(run_id, "pausing", by=by)
            self._keeper.owner.pause()
            _log("to be paused", run_id, by)
        self._keeper.news.tell()
        return run

    def resume(self, run_id: str, by: Actor) -> RunRecord:
        """Let a paused run go on, or queue one again that was ended before it was whole.

        Who asks for that wants light: it releases a bench that is kept dark.
        """
        with self._keeper.lock:
            run = self._own(run_id, by)
            if run.state in {"queued", "running"}:
                return run
            if run.state in FINAL:
                run = self._store.runs.move(run_id, "queued", by=by)
            else:
                run = self._store.runs.move(run_id, "running", by=by)
                self._keeper.owner.resume()
        _log("to go on", run_id, by)
        self._keeper.darkness.end(by)
        self._keeper.wake()
        return run

    def abort(self, run_id: str, by: Actor) -> RunRecord:
        """End a run for good."""
        with self._keeper.lock:
            run = self._own(run_id, by)
            if run.state in {"aborting", "cancelled"}:
                return run
            if run.state in {"queued", "interrupted"}:
                run = self._store.runs.move(run_id, "cancelled", by=by)
            else:
                run = self._store.runs.move(run_id, "aborting", by=by)
                self._keeper.owner.abort()
        _log("to end", run_id, by)
        self._keeper.wake()
        return run

    def safe_off(self, by: Actor) -> BenchLook:
        """Switch every lamp off, whoever has the bench, and return what was read back.

        Nothing is waited for before the command goes out: no lock, no queue, no record. Queued
        runs wait from then on, also where it did not answer, until somebody releases the bench or
        asks for a run.
        """
        self._keeper.darkness.begin(by)
        try:
            look = self._keeper.owner.safe_off()
            _LOG.warning("every lamp is switched off, by %s; runs wait", by.name)
        finally:
            self._keeper.darkness.record(by)
        return look

    def release(self, by: Actor) -> None:
        """Let runs begin again after safe-off; nothing where they may."""
        self._keeper.darkness.end(by)
        _LOG.warning("the bench is released, by %s", by.name)
        self._keeper.wake()

    def look(self, by: Actor) -> BenchLook:
        """Ask every device how it is; BenchHeldError where somebody else has the bench."""
        run = self._store.runs.under_way()
        if run is not None and run.submitted_by != by.name:
            raise BenchHeldError(run.submitted_by)
        return self._keeper.owner.look_now()

    def _own(self, run_id: str, by: Actor) -> RunRecord:
        run = self._store.runs.get(run_id)
        if run.submitted_by != by.name:
            raise BenchHeldError(run.submitted_by)
        return run


def _log(what: str, run_id: str, by: Actor) -> None:
    _LOG.info("the run is %s, by %s", what, by.name, extra={"run": run_id})
