"""How well signatures explain what is left of a recording, linearly."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import log

from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.evidence.point import Point
from calib.diagnosis.evidence.projection import orthonormal, without
from calib.diagnosis.signatures.signature import Signature, retaken
from calib.diagnosis.simulation.response import Responder
from calib.diagnosis.statistics.change import Change

SHARPEN = 0.3
"""Effects that explain this share of what the best one does are looked at more closely."""
SHAPES_SHARPENED = 2
FREE = 4.0
"""By this factor a shape without a strength of its own may be off before it is fitted."""


@dataclass(frozen=True)
class Score:
    """How well one signature explains a residual.

    Attributes:
        signature: Which.
        amplitude: In units of the signature's strength.
        gain: Deviance explained.
        net: The same after the penalty for the shapes that were tried.
        course: What frees its course in time, where that is worth its price.
    """

    signature: Signature
    amplitude: float
    gain: float
    net: float
    course: tuple[tuple[Change, Point], ...] = ()

    @property
    def name(self) -> str:
        """The effect's name."""
        return self.signature.shape.name


def sharpened(ranked: Sequence[Score], evidence: Evidence, responder: Responder) -> list[Signature]:
    """Return the signatures of what is ranked, the best of them taken anew.

    Signatures bend: those are taken at the strength that the recording asks for.
    """
    seen: dict[str, int] = {}
    found = []
    for score in ranked:
        seen[score.name] = seen.get(score.name, 0) + 1
        close = score.net > SHARPEN * ranked[0].net and seen[score.name] <= SHAPES_SHARPENED
        one = score.signature
        found.append(retaken(one, score.amplitude, evidence, responder) if close else one)
    return found


def scores(
    signatures: Sequence[Signature],
    residual: Point,
    directions: Sequence[Point],
    evidence: Evidence,
) -> list[Score]:
    """Return what each signature explains of `residual` beside `directions`, the best first."""
    tried: dict[str, int] = {}
    for each in signatures:
        tried[each.shape.name] = tried.get(each.shape.name, 0) + 1
    basis = orthonormal(directions, evidence)
    found = []
    for each in signatures:
        point = without(each.point, basis, evidence)
        length2 = evidence.product(point, point)
        if length2 < 1e-3 * each.length**2 or length2 <= 0:
            continue
        along = evidence.product(point, residual)
        amplitude = along / length2
        if not each.shape.two_sided:
            amplitude = max(amplitude, 0.0)
        if each.shape.fixed:
            free = FREE if each.shape.inner else 1.0
            amplitude = min(max(amplitude, 1.0 / free), free)
        gain = length2 * amplitude * (2.0 * along / length2 - amplitude)
        net = gain - each.shape.cost - 2.0 * log(tried[each.shape.name])
        found.append(Score(each, amplitude, gain, net))
    return sorted(found, key=lambda score: -score.net)


def best_by_name(ranked: Sequence[Score]) -> list[Score]:
    """Return the best score of each name, the best first."""
    best: dict[str, Score] = {}
    for score in ranked:
        if score.name not in best or score.net > best[score.name].net:
            best[score.name] = score
    return sorted(best.values(), key=lambda score: -score.net)
