"""The whole store against its files: what is missing, altered or left over, and why."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from service.settings import Settings
from service.store.audit import START
from service.store.check.every import every
from service.store.check.finding import Finding, Kind
from service.store.check.left_over import left_over, under_way
from service.store.check.recordings import check_recording
from service.store.check.runs import check_run
from service.store.check.sets import check_set
from service.store.errors import StoreError
from service.store.records import JobRecord, RecordingRecord, SetRecord
from service.store.run_records import RunRecord
from service.store.store import Store

Progress = Callable[[float, str], None]


@dataclass(frozen=True)
class Checked:
    """How much was looked at, and what was found; `audit_digest` is the log's last one."""

    coefficient_sets: int
    recordings: int
    runs: int
    audit_entries: int
    audit_digest: str
    findings: tuple[Finding, ...]

    @property
    def is_whole(self) -> bool:
        """Tell whether nothing is lost: left-overs only take room."""
        return not any(each.kind.is_harm for each in self.findings)


@dataclass(frozen=True)
class _Known:
    sets: tuple[SetRecord, ...]
    recordings: tuple[RecordingRecord, ...]
    runs: tuple[RunRecord, ...]
    jobs: tuple[JobRecord, ...]


def check(settings: Settings, progress: Progress) -> Checked:
    """Read everything that the store of `settings` names; change nothing.

    Raises:
        StoreError: The database itself cannot be used.
    """
    with Store.look(settings) as store:
        trouble = store.damage()
        if trouble is not None:
            text = f"the database is damaged ({trouble}); restore it from a copy"
            found = Finding(Kind.ALTERED, "database", None, text)
            return Checked(0, 0, 0, 0, START, (found,))
        runs = tuple(every(store.runs.list))  # first: what they recorded is then on record
        known = _Known(
            tuple(every(store.sets.list)),
            tuple(every(store.recordings.list)),
            runs,
            tuple(every(store.jobs.list)),
        )
        findings = [*_left_over(settings, known), *_wrong(store, settings, known, progress)]
        try:
            entries, digest = store.audit.verify()
        except StoreError as error:
            entries, digest = 0, START
            findings.append(Finding(Kind.ALTERED, "audit", None, str(error)))
    n_sets, n_recordings, n_runs = len(known.sets), len(known.recordings), len(known.runs)
    return Checked(n_sets, n_recordings, n_runs, entries, digest, tuple(findings))


def _wrong(
    store: Store, settings: Settings, known: _Known, progress: Progress
) -> Iterator[Finding]:
    logged = store.audit.last_actions()
    for record in known.sets:
        if any(check_set(record, store.sets.files, logged.get(record.id))):
            # Once more: it may have been certified between one look and the other.
            now, logged = store.sets.get(record.id), store.audit.last_actions()
            yield from check_set(now, store.sets.files, logged.get(record.id))
    digests = {each.digest for each in known.recordings}
    for run in known.runs:
        yield from check_run(run, settings.runs_folder, digests)
    for number, recording in enumerate(known.recordings):
        progress(number / len(known.recordings), recording.name)
        for finding in check_recording(recording):
            if store.recordings.knows(recording.digest):  # it may have been deleted meanwhile
                yield finding


def _left_over(settings: Settings, known: _Known) -> Iterator[Finding]:
    sets = {each.id for each in known.sets}
    recordings = {each.digest for each in known.recordings}
    runs, jobs = ({each.id for each in these} for these in (known.runs, known.jobs))
    yield from left_over(
        settings.sets_folder,
        lambda path: path.suffix == ".h5" and path.stem in sets,
        "no record names {path}: add it with darkflat store add, or delete it",
    )
    yield from left_over(
        settings.recordings_folder,
        lambda path: path.name in recordings,
        "no record names {path}: make it known with darkflat store add-recording, or delete it",
    )
    yield from left_over(
        settings.runs_folder,
        lambda path: path.name.partition(".")[0] in runs,
        "no run on record made {path}: make it known, or delete it",
    )
    yield from left_over(
        settings.jobs_folder,
        lambda path: path.name in jobs,
        "no job on record left {path}: delete it",
    )
    yield from under_way(settings.work_folder)
