"""Looks for the cheapest plan that is expected to tell a finding's names apart."""

from dataclasses import dataclass, replace

import numpy as np

from calib.diagnosis.answer.next_measurement import NextMeasurement
from calib.diagnosis.deciding.bench import BenchTime, at_the_pace_of, timed
from calib.diagnosis.deciding.family import Option, options
from calib.diagnosis.deciding.plan_text import plan_of
from calib.diagnosis.deciding.planned import with_planned
from calib.diagnosis.deciding.reduced import reduced
from calib.diagnosis.deciding.rivals import Rivals, is_open, rivals_of
from calib.diagnosis.deciding.separation import separation
from calib.diagnosis.deciding.testable import made_testable
from calib.diagnosis.diagnose import Examination
from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.recorded.joint import Joint
from calib.recording.header import RecordingHeader

ENOUGH_SIGMA = 5.0
"""A separation at which a wrong name wins by chance once in two million."""
PAID_SIGMA = 1.5
"""By this factor the best plan has to beat a cheaper one where none reaches what is wanted."""


@dataclass(frozen=True)
class Judged:
    """A plan with what it costs and what is expected of it."""

    option: Option
    seconds: float
    sigma: float


def next_measurement(
    examined: Examination,
    header: RecordingHeader,
    bench: BenchTime | None = None,
    *,
    wanted_sigma: float = ENOUGH_SIGMA,
    most_s: float = float("inf"),
) -> NextMeasurement | None:
    """Return what to measure next; None where nothing is left to ask.

    Args:
        examined: The diagnosis of what was recorded so far.
        header: Of the recording.
        bench: Where it would be measured; a usual one where it is not known.
        wanted_sigma: The separation to reach.
        most_s: The longest plan that is of use.
    """
    table = examined.evidence.table
    where = at_the_pace_of(table, bench or BenchTime(table.line_period_us))
    open_ = [finding for finding in examined.diagnosis.findings if is_open(finding)]
    if not open_:
        return made_testable(examined, header, where, most_s)
    rivals = rivals_of(max(open_, key=lambda f: f.significance_sigma), examined)
    if len(rivals.members) < 2:
        return None
    judged = judged_plans(rivals, examined.evidence, where, wanted_sigma, most_s)
    if not judged:
        return None
    best = chosen(judged, wanted_sigma)
    names = " from ".join([rivals.names[0], " and ".join(rivals.names[1:])])
    plan = plan_of(best.option.plan, header, name=best.option.what, monitor=best.option.monitor)
    return NextMeasurement(
        f"tells {names}: {best.option.what}",
        plan,
        best.sigma,
        separation(*reduced(rivals, examined.evidence)),
        best.seconds,
        best.sigma >= wanted_sigma,
    )


def judged_plans(
    rivals: Rivals, evidence: Evidence, bench: BenchTime, wanted_sigma: float, most_s: float
) -> tuple[Judged, ...]:
    """Return plans with their expected separations, the cheapest first, up to one that suffices."""
    ended_s = float((evidence.table.started_s + evidence.table.n_lines * _period_s(evidence)).max())
    costed = []
    for option in options(evidence, bench):
        blocks, seconds = timed(option.plan, bench, ended_s + bench.starts_in_s)
        costed.append((seconds, option, blocks))
    judged, (there, small, factor) = [], reduced(rivals, evidence)
    for seconds, option, blocks in sorted(costed, key=lambda each: each[0]):
        if seconds > most_s:
            break
        both = with_planned(small, blocks)
        found = Judged(option, seconds, separation(there, both, factor))
        judged.append(found)
        if found.sigma >= wanted_sigma:
            break
    return tuple(judged)


def chosen(judged: tuple[Judged, ...], wanted_sigma: float) -> Judged:
    """Return the cheapest plan that suffices, else the best, cheaper ones preferred."""
    best = judged[0]
    for each in judged[1:]:
        enough = best.sigma >= wanted_sigma
        if not enough and (each.sigma >= wanted_sigma or each.sigma > PAID_SIGMA * best.sigma):
            best = each
    return best


def decided(examined: Examination, whole: Joint, bench: BenchTime | None = None) -> Examination:
    """Return the examination with the next measurement, and what is taken for common, told."""
    following = next_measurement(examined, whole.header, bench)
    diagnosis = replace(examined.diagnosis, next_measurement=following)
    if whole.note:
        diagnosis = replace(diagnosis, remarks=(*diagnosis.remarks, whole.note))
    return replace(examined, diagnosis=diagnosis)


def _period_s(evidence: Evidence) -> float:
    return float(np.float64(evidence.table.line_period_us) * 1e-6)
