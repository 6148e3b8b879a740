"""Looks for the catalogue's effects: the best signature is added, all are refitted, and again."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import log

import numpy as np

from calib.diagnosis.evidence import Evidence
from calib.diagnosis.model import Member, Model
from calib.diagnosis.point import Point
from calib.diagnosis.projection import orthonormal, without
from calib.diagnosis.refit import refitted
from calib.diagnosis.response import Responder
from calib.diagnosis.signatures import Signature, retaken

THRESHOLD = 16.0
"""Deviance, after its penalty, that chance alone reaches in about two of a hundred recordings."""
MOST_EFFECTS = 4
IMPERFECT = 0.004
"""Signatures are this accurate, in deviance: what is left of a strong effect is no other one."""
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
    """

    signature: Signature
    amplitude: float
    gain: float
    net: float


def find(signatures: Sequence[Signature], evidence: Evidence, responder: Responder) -> Model:
    """Return the effects that explain the recording better than chance, jointly fitted."""
    observed = evidence.observed()
    residual = evidence.point(observed)
    model, first_gain = Model((), None, observed, residual, residual, evidence.baseline), 0.0
    while len(model.members) < MOST_EFFECTS:
        ranked = ranking(signatures, model, evidence, responder)
        needed = max(THRESHOLD, IMPERFECT * first_gain)
        if not ranked or ranked[0].net < needed:
            break
        first_gain = max(first_gain, ranked[0].gain)
        model = pruned(added(model, ranked[0], evidence, responder), evidence, responder)
    return model


def ranking(
    signatures: Sequence[Signature], model: Model, evidence: Evidence, responder: Responder
) -> list[Score]:
    """Return what each effect explains of the residual, the best first.

    Signatures bend: the best of them are taken anew at the strength that the recording asks for.
    """
    named = {m.signature.shape.name for m in model.members}
    left = [s for s in signatures if s.shape.name not in named]
    directions = [d for m in model.members for d in m.directions]
    ranked = scores(left, model.residual, directions, evidence)
    if not ranked or ranked[0].net < THRESHOLD / 2:
        return ranked
    seen: dict[str, int] = {}
    sharper, others = [], []
    for score in ranked:
        name = score.signature.shape.name
        seen[name] = seen.get(name, 0) + 1
        if score.net > SHARPEN * ranked[0].net and seen[name] <= SHAPES_SHARPENED:
            sharper.append(retaken(score.signature, score.amplitude, evidence, responder))
        else:
            others.append(score)
    again = scores(sharper, model.residual, directions, evidence)
    tried = {n: sum(s.shape.name == n for s in left) for n in seen}
    again = [replace(s, net=s.gain - 2.0 * log(tried[s.signature.shape.name])) for s in again]
    return sorted([*again, *others], key=lambda score: -score.net)


def pruned(model: Model, evidence: Evidence, responder: Responder) -> Model:
    """Return the model without effects that the later ones have made superfluous."""
    for k in range(len(model.members) - 1):
        others = [d for j, m in enumerate(model.members) if j != k for d in m.directions]
        rest = without(model.members[k].directions[0], orthonormal(others, evidence), evidence)
        own = model.members[k].strength ** 2 * evidence.product(rest, rest)
        if own < THRESHOLD and not model.members[k].signature.shape.fixed:
            kept = tuple(m for j, m in enumerate(model.members) if j != k)
            return pruned(
                refitted(replace(model, members=kept), evidence, responder), evidence, responder
            )
    return model


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
        found.append(Score(each, amplitude, gain, gain - 2.0 * log(tried[each.shape.name])))
    return sorted(found, key=lambda score: -score.net)


def added(model: Model, score: Score, evidence: Evidence, responder: Responder) -> Model:
    """Return the model with one effect more, refitted."""
    signature = score.signature
    ratio = abs(score.amplitude) ** (1.0 / signature.power)
    strength = float(np.sign(score.amplitude) * ratio * signature.strength)
    if signature.shape.fixed:
        strength = 1.0
    member = Member(signature, strength, {}, (0.0,), (signature.change,), (signature.point,))
    return refitted(replace(model, members=(*model.members, member)), evidence, responder)
