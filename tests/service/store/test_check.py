"""What is missing, altered or left over in a store is found and explained; nothing is changed."""

import hashlib
import shutil
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import h5py
import pytest
from sqlalchemy import text

from calib.radiometric.coefficients.provenance import Provenance
from calib.recording.commit_log import commit_path
from calib.recording.open import open_recording
from service.settings import Settings
from service.store.actor import Actor
from service.store.check.check import Checked
from service.store.check.check import check as look_through
from service.store.check.finding import Kind
from service.store.engine import reading_session, writing_session
from service.store.errors import StoreError
from service.store.store import Store
from tests.service.cli.a_recording import plan_file, recording_file
from tests.service.store.a_store import a_set, certified, day

__all__ = ["plan_file", "recording_file"]
ADA = Actor("ada")
EMPTY = pytest.mark.parametrize("url", ["sqlite", "postgresql-empty"], indirect=True)


@dataclass(frozen=True)
class Filled:
    """A store with one of each, and what these are called."""

    settings: Settings
    set_id: str
    recording: str
    done: str
    cut_short: str

    def check(self) -> Checked:
        return look_through(self.settings, lambda *_: None)

    def change(self, *statements: str) -> None:
        with Store.open(self.settings) as store, writing_session(store._engine) as session:
            for statement in statements:
                session.execute(text(statement))

    def set_file(self) -> Path:
        return self.settings.sets_folder / f"{self.set_id}.h5"

    def recording_file(self) -> Path:
        return self.settings.recordings_folder / self.recording / "recording.h5"

    def run_file(self) -> Path:
        return self.settings.runs_folder / f"{self.cut_short}.h5"


def copied(recording: Path, to: Path) -> Path:
    to.parent.mkdir(parents=True, exist_ok=True)
    shutil.copy(recording, to)
    shutil.copy(commit_path(recording), commit_path(to))
    return to


@pytest.fixture
def filled(url: str, tmp_path: Path, recording_file: Path) -> Filled:
    settings = Settings(home=tmp_path / "home", store_url=url)
    digest = open_recording(recording_file).digest()
    kept = copied(recording_file, settings.recordings_folder / digest / "recording.h5")
    with Store.open(settings) as store:
        store.recordings.register(open_recording(kept), name="sweep 3", by=ADA, digest=digest)
        made = certified(store, a_set(), day(1))
        runs = [store.runs.submit({}, "ab", blocks_total=9, by=ADA)[0].id for _ in range(2)]
        for run in runs:
            store.runs.move(run, "running")
            store.runs.progress(run, "progress", {"blocks_done": 9})
        store.runs.move(runs[0], "succeeded", recording_digest=digest)
        store.runs.interrupt_all()
    copied(recording_file, settings.runs_folder / f"{runs[1]}.h5")
    return Filled(settings, made.id, digest, runs[0], runs[1])


def test_a_store_that_is_whole(filled: Filled) -> None:
    checked = filled.check()
    assert (checked.is_whole, checked.findings) == (True, ())
    assert (checked.coefficient_sets, checked.recordings, checked.runs) == (1, 1, 2)
    with Store.open(filled.settings) as store:
        assert (checked.audit_entries, checked.audit_digest) == store.audit.verify()


def overwrite(path: Path) -> None:
    path.write_bytes(b"not what it was")


def flip_a_frame(path: Path) -> None:
    with h5py.File(path, "r+") as file:
        file["frames"][0, 0, 0] ^= 1


def another_recording(path: Path) -> None:
    """One block fewer: sound in itself, but not what was known by this digest."""
    lines = commit_path(path).read_text().splitlines(keepends=True)
    commit_path(path).write_text("".join(lines[: len(lines) // 2]))


Damage = Callable[[Filled], None]
HARM: dict[str, tuple[Damage, Kind, Callable[[Filled], str], str]] = {
    "no set file": (
        lambda f: f.set_file().unlink(), Kind.MISSING, lambda f: f.set_id, "restore it"),
    "set file": (
        lambda f: overwrite(f.set_file()), Kind.ALTERED, lambda f: f.set_id, "calibrate again"),
    "another set's file": (
        lambda f: a_set(99.0).save(f.set_file()), Kind.ALTERED, lambda f: f.set_id, "another set"),
    "a set's camera": (
        lambda f: f.change("UPDATE coefficient_sets SET camera_serial = 'B0002'"),
        Kind.ALTERED, lambda f: f.set_id, "camera_serial = 'B0002'"),
    "a set's state": (
        lambda f: f.change("UPDATE coefficient_sets SET state = 'revoked'"),
        Kind.ALTERED, lambda f: f.set_id, "on record as revoked"),
    "a set's state and life": (
        lambda f: f.change(
            "UPDATE coefficient_sets SET state = 'revoked'",
            "UPDATE transitions SET after = 'revoked' WHERE after = 'certified'"),
        Kind.ALTERED, lambda f: f.set_id, "the audit log with coefficient-set.certified"),
    "no recording": (
        lambda f: shutil.rmtree(f.recording_file().parent),
        Kind.MISSING, lambda f: f.recording, "put it back"),
    "no commit record": (
        lambda f: commit_path(f.recording_file()).unlink(),
        Kind.MISSING, lambda f: f.recording, "recording.frames.jsonl"),
    "a frame": (
        lambda f: flip_a_frame(f.recording_file()), Kind.ALTERED, lambda f: f.recording, "CRC"),
    "no HDF5": (
        lambda f: overwrite(f.recording_file()), Kind.ALTERED, lambda f: f.recording, "sweep 3"),
    "half a recording": (
        lambda f: another_recording(f.recording_file()),
        Kind.ALTERED, lambda f: f.recording, "its digest is"),
    "a run's recording off the record": (
        lambda f: f.change("DELETE FROM recordings"),
        Kind.MISSING, lambda f: f.done, "not on record"),
    "what a run can go on with": (
        lambda f: f.run_file().unlink(), Kind.MISSING, lambda f: f.cut_short, "interrupted"),
    "an audit entry": (
        lambda f: f.change("UPDATE audit SET who = 'eve' WHERE number = 2"),
        Kind.ALTERED, lambda f: "audit", "entry 2"),
}  # fmt: skip


@pytest.mark.parametrize("url", ["sqlite"], indirect=True)
@pytest.mark.parametrize("case", HARM)
def test_what_is_missing_or_altered_is_found_and_explained(filled: Filled, case: str) -> None:
    damage, kind, subject, why = HARM[case]
    damage(filled)
    checked = filled.check()
    assert not checked.is_whole
    first = next(each for each in checked.findings if each.kind.is_harm)
    assert (first.kind, first.subject) == (kind, subject(filled))
    assert why in first.text
    assert sum(each.kind.is_harm for each in checked.findings) == 1


def test_what_is_left_over_is_told_and_loses_nothing(filled: Filled) -> None:
    sets, work = filled.settings.sets_folder, filled.settings.work_folder
    a_set(99.0).save(sets / f"{a_set(99.0).id}.h5")
    (sets / f".{'0' * 64}.h5.x1y2").write_bytes(b"half")
    work.mkdir()
    (work / "import-1").mkdir()
    (filled.settings.jobs_folder / "4567").mkdir(parents=True)
    stray = copied(filled.run_file(), filled.settings.runs_folder / "0123.h5")
    (filled.settings.recordings_folder / ("0" * 64)).mkdir()
    (filled.settings.runs_folder / ".partial-x.h5").write_bytes(b"half")
    checked = filled.check()
    assert checked.is_whole
    assert sorted((each.kind, each.subject) for each in checked.findings) == sorted([
        (Kind.ORPHANED, f"{a_set(99.0).id}.h5"), (Kind.HALF_WRITTEN, f".{'0' * 64}.h5.x1y2"),
        (Kind.HALF_WRITTEN, "import-1"), (Kind.ORPHANED, "0123.h5"),
        (Kind.ORPHANED, commit_path(stray).name), (Kind.ORPHANED, "0" * 64),
        (Kind.HALF_WRITTEN, ".partial-x.h5"), (Kind.ORPHANED, "4567"),
    ])  # fmt: skip


def test_a_set_whose_recording_was_never_known_is_no_harm(filled: Filled) -> None:
    with Store.open(filled.settings) as store:
        store.sets.add(a_set(12.0), by=ADA)
    assert Provenance("0" * 64).recording_digest == a_set(12.0).provenance.recording_digest
    assert filled.check().findings == ()


def contents(folder: Path) -> dict[str, str]:
    return {
        str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in folder.rglob("*")
        if path.is_file() and "sqlite" not in path.name
    }


def test_nothing_is_changed_and_nothing_can_be(filled: Filled) -> None:
    overwrite(filled.set_file())
    before = contents(filled.settings.home)
    filled.check()
    assert contents(filled.settings.home) == before
    with Store.look(filled.settings) as store:
        with pytest.raises(StoreError) as refused:
            store.audit.record(ADA, "bench.safe-off", "bench")
        assert refused.value.code == "store-not-writable"


@EMPTY
def test_a_store_that_is_not_there_is_not_made(url: str, tmp_path: Path) -> None:
    settings = Settings(home=tmp_path / "home", store_url=url)
    with pytest.raises(StoreError) as refused:
        look_through(settings, lambda *_: None)
    assert refused.value.code == "no-store"
    assert list(tmp_path.iterdir()) == []


@EMPTY
def test_an_older_store_is_left_as_it_is(url: str, tmp_path: Path) -> None:
    settings = Settings(home=tmp_path / "home", store_url=url)
    with Store.open(settings) as store:
        with writing_session(store._engine) as session:
            session.execute(text("UPDATE alembic_version SET version_num = '0002'"))
        with pytest.raises(StoreError) as refused:
            look_through(settings, lambda *_: None)
        assert refused.value.code == "store-too-old"
        with reading_session(store._engine) as session:
            assert session.scalar(text("SELECT version_num FROM alembic_version")) == "0002"
