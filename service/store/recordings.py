"""Recordings that the store knows, each by the digest of its content."""

from datetime import UTC, datetime
from typing import TYPE_CHECKING, Literal

from sqlalchemy import Engine, select
from sqlalchemy.orm import Session

from service.store.actor import Actor
from service.store.audit import append
from service.store.engine import reading_session, writing_session
from service.store.find import find
from service.store.pages import Page, page
from service.store.plain_json import plain
from service.store.records import RecordingRecord
from service.store.references import check_unreferenced
from service.store.row_records import recording_record
from service.store.tables import RecordingRow

if TYPE_CHECKING:
    from calib.recording.protocol import Recording


class Recordings:
    """The records; the frames stay in the files, wherever these are."""

    def __init__(self, engine: Engine) -> None:
        self._engine = engine

    def register(
        self,
        recording: "Recording",
        *,
        name: str,
        by: Actor,
        digest: str | None = None,
        action: Literal["register", "import"] = "register",
    ) -> RecordingRecord:
        """Know `recording` by its digest, computed where not given.

        One that is known already only gets its new path, if it has one. The audit log says which
        `action` it was.
        """
        digest = digest or recording.digest()
        path = str(recording.path.absolute())
        with writing_session(self._engine) as session:
            row = session.scalar(select(RecordingRow).where(RecordingRow.digest == digest))
            if row is None:
                row = _new_row(recording, digest, name, path, by.name)
                session.add(row)
                append(session, by, f"recording.{action}", digest, after={"name": name})
            elif row.path != path:
                append(
                    session, by, "recording.move", digest,
                    before={"path": row.path}, after={"path": path},
                )  # fmt: skip
                row.path = path
            session.flush()
            return recording_record(row)

    def remove(self, digest: str, *, by: Actor) -> RecordingRecord:
        """Forget a recording that nothing refers to; return what was known of it.

        Raises:
            NotInStoreError: It is unknown.
            StoreError: `recording-in-use`.
        """
        with writing_session(self._engine) as session:
            row = _find(session, digest)
            check_unreferenced(session, digest)
            record = recording_record(row)
            append(session, by, "recording.delete", digest, before={"name": row.name})
            session.delete(row)
            return record

    def knows(self, digest: str) -> bool:
        """Tell whether a recording with this digest is registered."""
        with reading_session(self._engine) as session:
            known = select(RecordingRow.sequence).where(RecordingRow.digest == digest)
            return session.scalar(known) is not None

    def get(self, digest: str) -> RecordingRecord:
        """Return the record of the recording with this digest; NotInStoreError if unknown."""
        with reading_session(self._engine) as session:
            return recording_record(_find(session, digest))

    def list(
        self,
        *,
        serial: str | None = None,
        band: str | None = None,
        limit: int = 100,
        before: int | None = None,
    ) -> Page[RecordingRecord]:
        """Return a page of records, newest first; `before` is the last page's `next_before`."""
        query = select(RecordingRow)
        if serial is not None:
            query = query.where(RecordingRow.camera_serial == serial)
        if band is not None:
            query = query.where(RecordingRow.band == band)
        with reading_session(self._engine) as session:
            return page(
                session, query, RecordingRow.sequence, recording_record, limit=limit, before=before
            )


def _find(session: Session, digest: str) -> RecordingRow:
    msg = f"the store has no recording {digest!r}; register it first"
    return find(session, RecordingRow, RecordingRow.digest, digest, else_=msg)


def _new_row(recording: "Recording", digest: str, name: str, path: str, by: str) -> RecordingRow:
    header = recording.header
    started_at = header.camera.started_at
    if started_at is not None and started_at.tzinfo is None:
        started_at = started_at.replace(tzinfo=UTC)  # by definition of the folder
    return RecordingRow(
        digest=digest,
        name=name,
        path=path,
        camera_serial=header.camera.serial,
        band=header.camera.band,
        started_at=started_at,
        registered_at=datetime.now(UTC),
        registered_by=by,
        header=plain(header.model_dump(mode="json", exclude_none=True)),
        warnings=list(recording.warnings),
    )
