"""Runs: what they recorded is there, on record or to be gone on with."""

from collections.abc import Iterator
from pathlib import Path

from calib.recording.commit_log import commit_path
from service.store.check.finding import Finding, Kind
from service.store.run_records import RunRecord


def check_run(run: RunRecord, folder: Path, recordings: set[str]) -> Iterator[Finding]:
    """Look for what a run recorded."""
    if run.recording_digest is not None:
        if run.recording_digest not in recordings:
            text = (
                f"run {run.id} made recording {run.recording_digest[:12]}, which is not on record"
            )
            yield Finding(Kind.MISSING, run.id, None, f"{text}; make it known again")
        return
    path = folder / f"{run.id}.h5"
    for needed in (path, commit_path(path)):
        if run.blocks_done > 0 and not needed.is_file():
            text = f"{needed} of run {run.id} ({run.state}) is gone: restore it, or abort the run"
            yield Finding(Kind.MISSING, run.id, needed, text)
