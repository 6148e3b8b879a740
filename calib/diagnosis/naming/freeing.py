"""Frees the law of a name that competes, where what that explains is worth its price."""

from collections.abc import Sequence
from dataclasses import replace

from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.evidence.point import Point
from calib.diagnosis.evidence.projection import orthonormal, without
from calib.diagnosis.naming.courses import PRICE, course
from calib.diagnosis.naming.laws import leaves_parameters
from calib.diagnosis.naming.scores import Score

WORTH_FREEING = 16.0
"""Deviance, after its price, from which on a law is freed: what chance seldom reaches."""


def with_free_law(
    score: Score,
    residual: Point,
    basis: Sequence[Point],
    evidence: Evidence,
) -> Score:
    """Return the score of an effect whose law may be free with it free where that is worth it.

    Args:
        score: Of a signature.
        residual: What is to be explained.
        basis: Orthonormal directions in which other effects can adapt.
        evidence: The recording.
    """
    keeps = leaves_parameters(score.signature)
    if score.gain <= WORTH_FREEING and not keeps:
        return score
    parts = course(score.signature, residual, basis, evidence)
    points = [point for _, point in parts]
    own = orthonormal([without(score.signature.point, basis, evidence)], evidence)
    opened = orthonormal([without(p, [*basis, *own], evidence) for p in points], evidence)
    more = sum(evidence.product(each, residual) ** 2 for each in opened)
    price = PRICE * len(parts)
    if more - price < WORTH_FREEING:
        return score
    amplitude = score.amplitude
    if keeps:
        amplitude = _beside(score.signature.point, points, residual, basis, evidence)
    if keeps and amplitude <= 0.0:
        return score
    gain, net = score.gain + more, score.net + more - price
    return replace(score, amplitude=amplitude, gain=gain, net=net, course=parts)


def _beside(
    own: Point,
    points: Sequence[Point],
    residual: Point,
    basis: Sequence[Point],
    evidence: Evidence,
) -> float:
    """Return the amplitude that a shape has beside what frees its law.

    A scene whose edges show no coupling says nothing of what pairs elsewhere share.
    """
    law = orthonormal([without(point, basis, evidence) for point in points], evidence)
    rest = without(own, [*basis, *law], evidence)
    return evidence.product(rest, residual) / max(evidence.product(rest, rest), 1e-300)
