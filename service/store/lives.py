"""Moving a set through its life, with who, when and why written down."""

from datetime import UTC, datetime

from sqlalchemy.orm import Session

from calib.errors import InputError
from service.store.actor import Actor
from service.store.audit import append
from service.store.errors import OverlapError
from service.store.records import Certification
from service.store.state import SetState, check_transition
from service.store.tables import SetRow, TransitionRow


def enter(session: Session, row: SetRow, after: SetState, by: Actor, reason: str) -> None:
    """Move a set to `after` and write down who did so, when and why."""
    before = SetState(row.state) if row.state else None
    if before is not None:
        check_transition(row.id, before, after)
    row.state = after.value
    row.transitions.append(
        TransitionRow(
            before=before, after=after.value, at=datetime.now(UTC), by=by.name, reason=reason
        )
    )
    append(
        session,
        by,
        f"coefficient-set.{after.value}",
        row.id,
        before={"state": before},
        after={"state": after, "reason": reason},
    )


def supersede(
    session: Session,
    row: SetRow,
    wanted: Certification,
    by: Actor,
    *,
    standing: list[SetRow],
    named: set[str],
) -> None:
    """Let the sets that stand in the way end where the new one begins, if all were named."""
    unnamed = [other.id for other in standing if other.id not in named]
    if unnamed:
        msg = (
            f"coefficient set {unnamed[0][:12]} holds for the same camera setting during that"
            " time; end the validity before it, or name it as superseded"
        )
        raise OverlapError(msg, unnamed)
    for other in standing:
        if other.certification is None:
            continue
        if SetState(other.state) is SetState.CERTIFIED:
            enter(session, other, SetState.SUPERSEDED, by, f"superseded by {row.id}")
        other.certification.superseded_from = wanted.valid_from
        other.certification.superseded_by = row.id


def check_reason(reason: str) -> None:
    """Raise InputError `no-reason` where none is given."""
    if not reason.strip():
        msg = "a reason is missing: say why, for those who read the record later"
        raise InputError(msg, code="no-reason")
