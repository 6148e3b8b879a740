"""Whether a course that is free in time follows the signal instead: what does so is no drift.

Four functions of time, of two dozen, come near any course over a dozen blocks. A gain that grows
with the signal is told by one number, whatever the time, and where that explains as much as the
functions do, the plan has put the signal in the order that they found.
"""

from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.evidence.point import Point
from calib.diagnosis.evidence.projection import orthonormal, without
from calib.diagnosis.naming.contribution import contribution
from calib.diagnosis.naming.courses import PRICE
from calib.diagnosis.naming.laws import open_variable, scaled
from calib.diagnosis.naming.model import Member, Model
from calib.diagnosis.statistics.change import Change
from calib.forward.drift import settled
from calib.forward.parameter import parameters_of

SURE = 16.0
"""Deviance, prices counted, by which the signal has to explain more."""
TIME = "time_constant_s"


def follows_signal(k: int, model: Model, evidence: Evidence) -> bool:
    """Return whether the signal explains what member `k` does by a free course of time."""
    member = model.members[k]
    if not member.course or open_variable(member.signature) != "time":
        return False
    others = [m for j, m in enumerate(model.members) if j != k]
    beside = orthonormal(
        [d for m in others for d in (*m.directions, *(point for _, point in m.course))], evidence
    )
    seen = model.residual + contribution(member)

    def explained(*points: Point) -> float:
        basis = orthonormal([without(point, beside, evidence) for point in points], evidence)
        return float(sum(evidence.product(each, seen) ** 2 for each in basis))

    in_time = explained(*member.directions, *(point for _, point in member.course))
    by_signal = explained(evidence.point(_by_signal(member, evidence)))
    return by_signal - PRICE > in_time - PRICE * len(member.course) + SURE


def _by_signal(member: Member, evidence: Evidence) -> Change:
    """Return the member's change where it has the signal's course."""
    effect, table = member.signature.shape.template, evidence.table
    change = member.signature.change
    if TIME not in parameters_of(type(effect)):
        return change * 0.0
    so_far = settled(table.mid_s, float(getattr(effect, TIME)))
    return scaled(
        change, evidence.signal_dn / so_far / max(float(evidence.signal_dn.max()), 1e-300)
    )
