"""By how many standard deviations a plan is expected to tell two effects apart.

Of two effects, one true at the strength that was fitted: what of its signature the other cannot
imitate, at any strength and with any value of what else the data determine of it, is left over
when the wrong one is fitted. Its length, whitened, is the square root of the deviance by which the
true name is expected to win, with a standard deviation of 1 (a matched filter; the signatures are
taken to be straight about the fitted strengths). Signatures are not exact, and what a diagnosis
makes of that deviance is tempered accordingly; so is what is expected here, lest a plan that
only makes an effect stronger seem to tell its names apart.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from calib.diagnosis.deciding.rivals import Rivals
from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.evidence.point import Point
from calib.diagnosis.evidence.projection import orthonormal, without
from calib.diagnosis.naming.laws import DEGREE, laws
from calib.diagnosis.naming.model import Member
from calib.diagnosis.signatures.changes import change_of
from calib.diagnosis.signatures.template_error import temper
from calib.diagnosis.simulation.fitted_responder import responder_of
from calib.diagnosis.simulation.response import Responder

STEP = 0.1
"""Of a logarithm, for a derivative."""


def separation(rivals: Rivals, evidence: Evidence, factor: float = 1.0) -> float:
    """Return the least separation of any two rivals, whichever of them is true, tempered, sigma.

    Args:
        rivals: The names.
        evidence: Of what is recorded and planned.
        factor: By which sigmas are larger on the whole of the sensor.
    """
    pairs = [(s * factor, g * factor**2) for s, g in _of_pairs(rivals, evidence)]
    return min((s * float(np.sqrt(temper(gain))) for s, gain in pairs), default=0.0)


def distance(rivals: Rivals, evidence: Evidence) -> float:
    """Return the same of exact signatures: the root of the deviance that parts the names."""
    return min((s for s, _ in _of_pairs(rivals, evidence)), default=0.0)


def _of_pairs(rivals: Rivals, evidence: Evidence) -> list[tuple[float, float]]:
    """Return the distance of each ordered pair, and the deviance that the true one explains."""
    responder = responder_of(evidence)
    beside = [d for m in rivals.others for d in _directions(m, evidence, responder)]
    each = [_directions(member, evidence, responder) for member in rivals.members]
    return [
        (
            _left_over(each[true][0], rivals.members[wrong], each[wrong], beside, evidence),
            evidence.product(each[true][0], each[true][0]),
        )
        for true in range(len(each))
        for wrong in range(len(each))
        if true != wrong
    ]


def _directions(member: Member, evidence: Evidence, responder: Responder) -> list[Point]:
    """Return the whitened signature at the fitted strength, and what else the fit can change.

    A derivative by the strength would differ from the signature by curvature alone, a direction in
    which no fit can go far.
    """
    change = change_of((member.effect,), evidence, responder)
    whole = evidence.point(change)
    found = [whole]
    for name, value in member.inner.items():
        inner = {**member.inner, name: value * float(np.exp(STEP))}
        effect = replace(member, inner=inner).effect
        point = evidence.point(change_of((effect,), evidence, responder))
        found.append((point - whole) * (1.0 / STEP))
    if member.effect.any_law == "time":
        open_to = laws(replace(member.signature, change=change, point=whole), evidence)
        parts = [evidence.point(each) for each in open_to.parts]
        # A drift may come and go; that it steps is not what a plan has to allow for.
        for power in open_to.functions[:DEGREE]:
            terms = [part * float(much) for part, much in zip(parts, power, strict=True)]
            found.append(sum(terms[1:], terms[0]))
    return found


def _left_over(
    true: Point, wrong: Member, directions: Sequence[Point], beside: Sequence[Point],
    evidence: Evidence,
) -> float:  # fmt: skip
    basis = orthonormal(beside, evidence)
    target = without(true, basis, evidence)
    own = without(directions[0], basis, evidence)
    if evidence.product(own, target) > 0 or wrong.signature.shape.two_sided:
        # A strength that has a sign cannot imitate what points the other way.
        target = without(true, orthonormal([*beside, *directions], evidence), evidence)
    return float(np.sqrt(max(evidence.product(target, target), 0.0)))
