"""Which other effects would explain a finding as well, and how sure its name is."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import exp, log

from calib.diagnosis.evidence import Evidence
from calib.diagnosis.model import Member, Model
from calib.diagnosis.point import Point
from calib.diagnosis.projection import orthonormal, without
from calib.diagnosis.response import Responder
from calib.diagnosis.search import Score, scores
from calib.diagnosis.signatures import Signature, retaken

TEMPER = 0.8
"""Deviances are taken this many times: signatures are not exact, and grids are coarse."""
LEAST_PROBABILITY = 0.02
"""Of a candidate that is told."""
CLOSE = 25.0
"""Only names within so much deviance of the best one are looked at closely."""


@dataclass(frozen=True)
class Candidate:
    """One name for a finding.

    Attributes:
        effect: Its name.
        probability: Among the candidates.
        gain: Deviance that it explains beside the other effects.
    """

    effect: str
    probability: float
    gain: float


def candidates_of(
    k: int,
    model: Model,
    signatures: Sequence[Signature],
    evidence: Evidence,
    responder: Responder,
) -> tuple[Candidate, ...]:
    """Return the names that member `k` of the model could have, the likeliest first."""
    member = model.members[k]
    others = [m for j, m in enumerate(model.members) if j != k]
    directions = [d for m in others for d in m.directions]
    own = contribution(member)
    residual = model.residual + own
    basis = orthonormal(directions, evidence)
    rest = without(own, basis, evidence)
    gain = 2.0 * evidence.product(rest, residual) - evidence.product(rest, rest)
    taken = {m.signature.shape.name for m in model.members}
    left = [s for s in signatures if s.shape.name not in taken]
    ranked = scores(left, residual, directions, evidence)
    best = _best_by_name(ranked)
    close = [s for s in best.values() if s.net > gain - 4.0 * CLOSE - 0.2 * gain]
    sharper = [retaken(s.signature, s.amplitude, evidence, responder) for s in close]
    again = _best_by_name(scores(sharper, residual, directions, evidence))
    tried = {n: sum(s.shape.name == n for s in left) for n in again}
    nets = {n: s.gain - _penalty(s.signature, tried[n]) for n, s in again.items()}
    nets[member.signature.shape.name] = gain - _own_penalty(member, signatures)
    top = max(nets.values())
    weights = {n: exp(0.5 * TEMPER * max(v - top, -200.0)) for n, v in nets.items()}
    total = sum(weights.values())
    found = [Candidate(n, w / total, nets[n]) for n, w in weights.items()]
    kept = [c for c in found if c.probability >= LEAST_PROBABILITY]
    scale = sum(c.probability for c in kept)
    return tuple(
        sorted(
            (replace(c, probability=c.probability / scale) for c in kept),
            key=lambda c: -c.probability,
        )
    )


def contribution(member: Member) -> Point:
    """Return what the member contributes, linearly: its strength times its direction."""
    if member.signature.shape.fixed:
        return member.directions[0]
    return member.directions[0] * (member.strength / member.signature.power)


def _best_by_name(ranked: Sequence[Score]) -> dict[str, Score]:
    best: dict[str, Score] = {}
    for score in ranked:
        name = score.signature.shape.name
        if name not in best or score.gain > best[name].gain:
            best[name] = score
    return best


def _penalty(signature: Signature, tried: int) -> float:
    return 2.0 * log(max(tried, 1)) if signature is not None else 0.0


def _own_penalty(member: Member, signatures: Sequence[Signature]) -> float:
    """Return what the member's shapes cost, and what each parameter beside the strength does."""
    name = member.signature.shape.name
    tried = sum(s.shape.name == name for s in signatures)
    return 2.0 * log(max(tried, 1)) + 2.0 * len(member.inner)
