"""Which certification holds at a time, and which stand in the way of another one.

A certification holds from `valid_from` up to, but without, `valid_until`, or the time from which
another set supersedes it. At any time at most one set holds for a camera setting.
"""

from datetime import datetime

from sqlalchemy import ColumnElement, Select, and_, func, or_, select
from sqlalchemy.orm import Session

from calib.errors import InputError
from service.store.records import Certification
from service.store.row_records import certification
from service.store.state import SetState
from service.store.tables import CertificationRow, SetRow

_HOLDING = (SetState.CERTIFIED.value, SetState.SUPERSEDED.value)
_GAIN_TOLERANCE_DB = 1e-6
"""Two spellings of one gain differ by less, two settings of a camera by more."""


def same_setting(
    serial: str, band: str, gain_db: float, bit_depth: int, region: str | None = None
) -> tuple[ColumnElement[bool], ...]:
    """Return the conditions on a set for this camera at this setting; None is any region."""
    of_region = () if region is None else (SetRow.region == region,)
    return (
        *of_region,
        SetRow.camera_serial == serial,
        SetRow.band == band,
        func.abs(SetRow.gain_db - gain_db) < _GAIN_TOLERANCE_DB,
        SetRow.bit_depth == bit_depth,
    )


def holding(at: datetime) -> Select[SetRow]:
    """Return the query for sets that hold at `at`."""
    return (
        select(SetRow)
        .join(SetRow.certification)
        .where(
            SetRow.state.in_(_HOLDING),
            CertificationRow.valid_from <= at,
            or_(CertificationRow.valid_until.is_(None), CertificationRow.valid_until > at),
            or_(CertificationRow.superseded_from.is_(None), CertificationRow.superseded_from > at),
        )
    )


def standing_in_the_way(session: Session, row: SetRow, wanted: Certification) -> list[SetRow]:
    """Return the other sets of the same camera setting that hold during `wanted`."""
    query = (
        select(SetRow)
        .join(SetRow.certification)
        .where(
            SetRow.state.in_(_HOLDING),
            SetRow.id != row.id,
            *same_setting(row.camera_serial, row.band, row.gain_db, row.bit_depth, row.region),
        )
    )
    if wanted.valid_until is not None:
        query = query.where(and_(CertificationRow.valid_from < wanted.valid_until))
    return [
        other
        for other in session.scalars(query).unique()
        if other.certification is not None
        and _ends_after(certification(other.certification), wanted.valid_from)
    ]


def _ends_after(standing: Certification, start: datetime) -> bool:
    until = standing.until
    # One that was superseded before it began holds for no time at all.
    holds_at_all = until is None or until > standing.valid_from
    return holds_at_all and (until is None or until > start)


def check_range(wanted: Certification) -> Certification:
    """Return `wanted`; InputError `bad-validity` when it ends before it begins."""
    if wanted.valid_until is not None and wanted.valid_until <= wanted.valid_from:
        msg = (
            f"the validity ends at {wanted.valid_until.isoformat()}, not after its start at"
            f" {wanted.valid_from.isoformat()}; give a later end, or none"
        )
        raise InputError(msg, code="bad-validity")
    return wanted
