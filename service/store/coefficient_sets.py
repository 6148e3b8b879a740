"""Coefficient sets and their lives: draft, verified, certified, superseded, revoked.

Overlaps. For one camera (serial, region, band, gain, bit depth) at most one set holds at any
time. A certification whose range overlaps another's is refused, unless it names that one as
superseded: then the older holds up to the newer one's start and never again after it, so that what
was taken before is still corrected by what held then.
"""

from collections.abc import Iterable
from datetime import UTC, datetime
from typing import TYPE_CHECKING

from sqlalchemy import Engine, select
from sqlalchemy.orm import Session

from calib.errors import InputError
from service.store.actor import Actor
from service.store.engine import reading_session, writing_session
from service.store.errors import NotInStoreError
from service.store.find import find
from service.store.in_force import check_range, holding, same_setting, standing_in_the_way
from service.store.lives import check_reason, enter, supersede
from service.store.pages import Page, page
from service.store.plain_json import plain
from service.store.records import Certification, SetRecord
from service.store.row_records import set_record
from service.store.set_files import SetFiles
from service.store.state import SetState
from service.store.tables import CertificationRow, SetRow
from service.store.utc import aware

if TYPE_CHECKING:
    from calib.radiometric.coefficients.coefficient_set import CoefficientSet

_SHORTEST_PREFIX = 8


class CoefficientSets:
    """The records; the arrays are in `files`. Every change is one transaction."""

    def __init__(self, engine: Engine, files: SetFiles) -> None:
        self._engine = engine
        self.files = files

    def add(self, coefficients: "CoefficientSet", *, by: Actor, reason: str = "added") -> SetRecord:
        """Keep a set as draft; a set that is there already stays as it is."""
        self.files.put(coefficients)  # first: a record never names a file that is not there
        with writing_session(self._engine) as session:
            found = session.scalar(select(SetRow).where(SetRow.id == coefficients.id))
            if found is None:
                found = _new_row(coefficients, by)
                session.add(found)
                enter(session, found, SetState.DRAFT, by, reason)
                session.flush()
            return set_record(found)

    def get(self, set_id: str) -> SetRecord:
        """Return the record of `set_id`, or of the one set whose id begins so (8 digits or more).

        Raises:
            NotInStoreError: There is none, or more than one.
        """
        with reading_session(self._engine) as session:
            return set_record(_find(session, set_id))

    def list(
        self,
        *,
        state: SetState | None = None,
        serial: str | None = None,
        band: str | None = None,
        recording: str | None = None,
        limit: int = 100,
        before: int | None = None,
    ) -> Page[SetRecord]:
        """Return a page of records, newest first; `before` is the last page's `next_before`."""
        query = select(SetRow)
        wanted = {
            SetRow.state: state.value if state else None,
            SetRow.camera_serial: serial,
            SetRow.band: band,
            SetRow.recording_digest: recording,
        }
        for column, value in wanted.items():
            if value is not None:
                query = query.where(column == value)
        with reading_session(self._engine) as session:
            return page(session, query, SetRow.sequence, set_record, limit=limit, before=before)

    def lookup(
        self,
        *,
        serial: str,
        band: str,
        gain_db: float,
        bit_depth: int,
        at: datetime,
        region: str | None = None,
    ) -> SetRecord:
        """Return the set that is in force for this camera setting at `at`.

        Args:
            serial: Of the camera.
            band: Likewise.
            gain_db: Likewise.
            bit_depth: Likewise.
            at: Time, aware.
            region: `CameraHeader.region`; None where all certified sets are of one region.

        Raises:
            NotInStoreError: None is.
            InputError: `naive-time`, `several-regions`.
        """
        at = aware(at, "at")
        query = holding(at).where(*same_setting(serial, band, gain_db, bit_depth, region))
        with reading_session(self._engine) as session:
            found = [set_record(row) for row in session.scalars(query).unique()]
        if len(found) == 1:
            return found[0]
        if found:
            regions = " and ".join(sorted(each.region for each in found))
            msg = f"certified sets of camera {serial!r} hold for the regions {regions}; say which"
            raise InputError(msg, code="several-regions")
        msg = (
            f"no certified coefficient set holds for camera {serial!r}, band {band!r},"
            f" {gain_db:g} dB, {bit_depth} bits at {at.isoformat()}; certify one, or list them all"
        )
        raise NotInStoreError(msg)

    def verify(self, set_id: str, *, by: Actor, reason: str = "") -> SetRecord:
        """Say that somebody looked at a draft; its file is read and its content compared."""
        full_id = self.get(set_id).id
        self.files.load(full_id)
        return self._change(full_id, SetState.VERIFIED, by, reason)

    def certify(
        self,
        set_id: str,
        *,
        valid_from: datetime,
        valid_until: datetime | None,
        by: Actor,
        reason: str,
        supersedes: Iterable[str] = (),
    ) -> SetRecord:
        """Certify a verified set for `valid_from` up to, but without, `valid_until`.

        Raises:
            IllegalTransitionError: It is not verified.
            OverlapError: Others hold during that range and are not named in `supersedes`.
            InputError: `naive-time`, `bad-validity`, `no-reason`, or the file is altered.
        """
        check_reason(reason)
        until = None if valid_until is None else aware(valid_until, "valid_until")
        wanted = check_range(Certification(aware(valid_from, "valid_from"), until))
        named = {self.get(each).id for each in supersedes}
        full_id = self.get(set_id).id
        self.files.load(full_id)
        with writing_session(self._engine) as session:
            row = _find(session, full_id)
            enter(session, row, SetState.CERTIFIED, by, reason)
            standing = standing_in_the_way(session, row, wanted)
            supersede(session, row, wanted, by, standing=standing, named=named)
            row.certification = CertificationRow(
                valid_from=wanted.valid_from, valid_until=wanted.valid_until
            )
            session.flush()
            return set_record(row)

    def revoke(self, set_id: str, *, by: Actor, reason: str) -> SetRecord:
        """Say that a set was wrong: it holds for no time any more."""
        check_reason(reason)
        return self._change(self.get(set_id).id, SetState.REVOKED, by, reason)

    def _change(self, set_id: str, after: SetState, by: Actor, reason: str) -> SetRecord:
        with writing_session(self._engine) as session:
            row = _find(session, set_id)
            enter(session, row, after, by, reason)
            session.flush()
            return set_record(row)


def _new_row(coefficients: "CoefficientSet", by: Actor) -> SetRow:
    camera = coefficients.camera
    return SetRow(
        id=coefficients.id,
        camera_serial=camera.serial,
        band=camera.band,
        gain_db=camera.gain_db,
        bit_depth=camera.bit_depth,
        columns=camera.columns,
        region=camera.region,
        radiance_unit=coefficients.radiance_unit,
        recording_digest=coefficients.provenance.recording_digest,
        added_at=datetime.now(UTC),
        added_by=by.name,
        summary=plain(coefficients.summary()),
        certification=None,
    )


def _find(session: Session, set_id: str) -> SetRow:
    if _SHORTEST_PREFIX <= len(set_id) < 64 and set_id.isalnum():
        rows = session.scalars(select(SetRow).where(SetRow.id.startswith(set_id))).all()
        if len(rows) == 1:
            return rows[0]
    msg = f"the store has no coefficient set {set_id!r}, or several that begin so; list them"
    return find(session, SetRow, SetRow.id, set_id, else_=msg)
