"""The cheapest plan that makes effects testable that the recording could not have shown.

What each needs is told by the effect itself: see `calib.forward.plan_needs`.
"""

from calib.diagnosis.answer.next_measurement import NextMeasurement
from calib.diagnosis.deciding.bench import BenchTime, Taken, timed
from calib.diagnosis.deciding.family import options
from calib.diagnosis.deciding.plan_text import plan_of
from calib.diagnosis.diagnose import Examination
from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.shapes.of_effects import departures
from calib.recording.header import RecordingHeader


def made_testable(
    examined: Examination, header: RecordingHeader, bench: BenchTime, most_s: float
) -> NextMeasurement | None:
    """Return the plan that makes most effects testable, the cheapest of such; None where none."""
    evidence = examined.evidence
    best: tuple[int, float] = (0, 0.0)
    found: NextMeasurement | None = None
    for option in options(evidence, bench):
        _, seconds = timed(option.plan, bench, 0.0)
        names = newly_testable(option.plan, evidence)
        if seconds > most_s or (len(names), -seconds) <= best or not names:
            continue
        best = (len(names), -seconds)
        plan = plan_of(option.plan, header, name=option.what, monitor=option.monitor)
        why = f"makes {', '.join(names)} testable: {option.what}"
        found = NextMeasurement(why, plan, None, None, seconds, reached=True, makes_testable=names)
    return found


def newly_testable(plan: tuple[Taken, ...], evidence: Evidence) -> tuple[str, ...]:
    """Return effects that need no more than `plan` beside what is recorded."""
    before, camera = evidence.table.blocks, evidence.sensor.camera
    after = (*before, *(each.block for each in plan))
    return tuple(
        kind.name
        for kind in departures()
        if kind.why_not_testable(before, camera) is not None
        and kind.why_not_testable(after, camera) is None
    )
