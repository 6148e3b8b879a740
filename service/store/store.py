"""The store, opened: the database migrated, the folders known."""

from pathlib import Path
from typing import Self

from sqlalchemy import text

from calib.closing import Closing
from service.settings import Settings
from service.store.audit import Audit
from service.store.coefficient_sets import CoefficientSets
from service.store.counts import Counts
from service.store.engine import open_engine, reading_session, writing_session
from service.store.jobs import Jobs
from service.store.keys import Keys
from service.store.migrate import check_current, migrate
from service.store.recordings import Recordings
from service.store.runs import Runs
from service.store.set_files import SetFiles


class Store(Closing):
    """Holds the database's connections until closed; a context manager. Thread-safe.

    Attributes:
        sets: Coefficient sets and their lives.
        recordings: By digest.
        jobs: Long work.
        runs: What the bench was asked to measure.
        keys: Who may ask for what.
        audit: What was done.
        counts: Of runs and jobs, by state.
    """

    def __init__(self, url: str, sets_folder: Path, *, read_only: bool = False) -> None:
        """Open the database at `url` and bring it to this version's schema.

        Args:
            url: Of the database.
            sets_folder: Of the coefficient sets' files.
            read_only: Change nothing, not even the schema.

        Raises:
            StoreError: `bad-store-url`, `store-not-writable`, `store-busy`, `store-too-new`;
                `no-store` and `store-too-old` where nothing may be changed.
        """
        self._engine = open_engine(url, read_only=read_only)
        try:
            check_current(self._engine) if read_only else migrate(self._engine)
        except BaseException:
            self._engine.dispose()
            raise
        self.sets = CoefficientSets(self._engine, SetFiles(sets_folder))
        self.recordings = Recordings(self._engine)
        self.jobs = Jobs(self._engine)
        self.runs = Runs(self._engine)
        self.keys = Keys(self._engine)
        self.audit = Audit(self._engine)
        self.counts = Counts(self._engine)

    @classmethod
    def open(cls, settings: Settings) -> Self:
        """Open the store that the settings name."""
        return cls(settings.url, settings.sets_folder)

    @classmethod
    def look(cls, settings: Settings) -> Self:
        """Open the store that the settings name, as it is."""
        return cls(settings.url, settings.sets_folder, read_only=True)

    def damage(self) -> str | None:
        """Return what is wrong with SQLite's file; other databases see to that themselves."""
        if self._engine.dialect.name != "sqlite":
            return None
        with reading_session(self._engine) as session:
            told = session.scalar(text("PRAGMA integrity_check(1)"))
        return None if told == "ok" else str(told)

    def check_writable(self) -> None:
        """Raise StoreError unless a writing transaction can be begun and ended."""
        with writing_session(self._engine) as session:
            session.execute(text("UPDATE alembic_version SET version_num = version_num"))

    def close(self) -> None:
        """Release the database; safe to call twice."""
        self._engine.dispose()
