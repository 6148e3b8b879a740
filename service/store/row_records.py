"""Rows of the tables as records."""

from typing import cast

from service.store.records import (
    Certification,
    JobRecord,
    JobState,
    RecordingRecord,
    SetRecord,
    Transition,
)
from service.store.state import SetState
from service.store.tables import CertificationRow, JobRow, RecordingRow, SetRow, TransitionRow


def set_record(row: SetRow) -> SetRecord:
    """Return a coefficient set's row as a record."""
    return SetRecord(
        id=row.id,
        sequence=row.sequence,
        state=SetState(row.state),
        camera_serial=row.camera_serial,
        band=row.band,
        gain_db=row.gain_db,
        bit_depth=row.bit_depth,
        columns=row.columns,
        region=row.region,
        radiance_unit=row.radiance_unit,
        recording_digest=row.recording_digest,
        added_at=row.added_at,
        added_by=row.added_by,
        summary=row.summary,
        certification=None if row.certification is None else certification(row.certification),
        transitions=tuple(_transition(each) for each in row.transitions),
    )


def certification(row: CertificationRow) -> Certification:
    """Return a certification's row as a record."""
    return Certification(row.valid_from, row.valid_until, row.superseded_from, row.superseded_by)


def _transition(row: TransitionRow) -> Transition:
    before = None if row.before is None else SetState(row.before)
    return Transition(before, SetState(row.after), row.at, row.by, row.reason)


def recording_record(row: RecordingRow) -> RecordingRecord:
    """Return a recording's row as a record."""
    return RecordingRecord(
        digest=row.digest,
        sequence=row.sequence,
        name=row.name,
        path=row.path,
        camera_serial=row.camera_serial,
        band=row.band,
        started_at=row.started_at,
        registered_at=row.registered_at,
        registered_by=row.registered_by,
        header=row.header,
        warnings=tuple(row.warnings),
    )


def job_record(row: JobRow) -> JobRecord:
    """Return a job's row as a record."""
    return JobRecord(
        id=row.id,
        sequence=row.sequence,
        kind=row.kind,
        state=cast("JobState", row.state),
        request=row.request,
        result=row.result,
        error_code=row.error_code,
        error_message=row.error_message,
        submitted_at=row.submitted_at,
        started_at=row.started_at,
        finished_at=row.finished_at,
    )
