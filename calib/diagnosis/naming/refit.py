"""Fits the strengths of all effects found, and what else the data determine of them, jointly."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.evidence.point import Point
from calib.diagnosis.evidence.projection import orthonormal, without
from calib.diagnosis.naming.courses import freed, with_courses
from calib.diagnosis.naming.derivatives import differentiated, which_moved
from calib.diagnosis.naming.laws import leaves_parameters
from calib.diagnosis.naming.model import Member, Model, foreseen
from calib.diagnosis.naming.rebase import rebased
from calib.diagnosis.naming.settled import Turn, most_settled, stalled
from calib.diagnosis.signatures.changes import change_of
from calib.diagnosis.simulation.response import Responder

Floats = NDArray[np.float64]

STEPS = 7
"""Of Gauss and Newton."""
LEAST_STEP = 0.05
"""In standard deviations: smaller steps end the fit."""
DETERMINED = 3.0
"""A parameter joins the fit where its logarithm is determined to one over this."""
FARTHEST = 0.7
"""By so much a logarithm may move at a time."""


def refitted(model: Model, evidence: Evidence, responder: Responder) -> Model:
    """Return the model with all parameters fitted jointly, by Gauss and Newton."""
    best, settled = _fitted(model, evidence, responder)
    prepared = _prepared(best, evidence, responder)
    if settled and [m.inner for m in prepared.members] == [m.inner for m in best.members]:
        return best
    return _fitted(prepared, evidence, responder)[0]


def _fitted(model: Model, evidence: Evidence, responder: Responder) -> tuple[Model, bool]:
    """Return the best of some steps, and whether more of them would be of no use."""
    members, baseline, tried = model.members, model.baseline, list[Turn]()
    derived: tuple[Member, ...] = ()
    for turn in range(STEPS):
        about = responder.about(baseline)
        plain = change_of(tuple(m.effect for m in members), evidence, about)
        far = which_moved(members, derived, evidence)
        found = [differentiated(k, members, plain, evidence, about) for k in far]
        members = _with(found, far, members)
        derived = _with(found, far, derived or members)
        members = with_courses(members, model.first - evidence.point(plain), evidence)
        change = plain + freed(members, plain)
        residual = model.first - evidence.point(change)
        steps, std = _solved(members, residual, evidence)
        members = _with_std(members, std)
        now = replace(model, members=members, change=change, residual=residual, baseline=baseline)
        told = _moving(members) & (std > 0.0)
        ahead = float(np.max(np.abs(reachable(steps, members)[told] / std[told]), initial=0.0))
        tried.append(Turn(now, ahead, misfit(now, evidence)))
        converged = ahead < LEAST_STEP and turn > 0
        if converged or stalled(tried):
            return most_settled(tried, evidence.product(model.first, model.first)), True
        stepped = _stepped(members, steps)
        # The step is that of effects and baseline together: what those take of it is not this's.
        missed = model.observed - change - foreseen(members, stepped)
        members, baseline = stepped, rebased(baseline, missed, evidence)
    return most_settled(tried, evidence.product(model.first, model.first)), False


def _with(
    found: Sequence[Member], far: Sequence[int], members: Sequence[Member]
) -> tuple[Member, ...]:
    """Return the members with those that were found in the places `far`."""
    new = dict(zip(far, found, strict=True))
    return tuple(new.get(k, member) for k, member in enumerate(members))


def reachable(steps: Floats, members: Sequence[Member]) -> Floats:
    """Return the steps as far as they can be gone: what has a sign is not less than nothing."""
    found, start = steps.copy(), 0
    for member in members:
        if not member.signature.shape.two_sided:
            found[start] = max(found[start], -member.strength)
        start += len(member.directions)
    return found


def _moving(members: Sequence[Member]) -> NDArray[np.bool_]:
    """Return which parameters can be stepped: a shape without strength has none to step."""
    flags = [
        not (member.signature.shape.fixed and k == 0)
        for member in members
        for k in range(len(member.directions))
    ]
    return np.array(flags)


def misfit(model: Model, evidence: Evidence) -> float:
    """Return the squared length of what remains."""
    return evidence.product(model.residual, model.residual)


def _solved(
    members: Sequence[Member], residual: Point, evidence: Evidence
) -> tuple[Floats, Floats]:
    """Return the steps of all parameters, and their standard uncertainties, laws left free."""
    moving = _moving(members)
    free = orthonormal([point for m in members for _, point in m.course], evidence)
    directions = [without(d, free, evidence) for m in members for d in m.directions]
    gram = np.array([[evidence.product(a, b) for b in directions] for a in directions])
    along = np.array([evidence.product(d, residual) for d in directions])
    gram[~moving] = gram[:, ~moving] = 0.0
    gram[~moving, ~moving] = 1.0
    along[~moving] = 0.0
    scale = 1.0 / np.sqrt(np.maximum(np.diag(gram), 1e-300))
    covariance = np.linalg.pinv(gram * np.outer(scale, scale), rcond=1e-9) * np.outer(scale, scale)
    return covariance @ along, np.sqrt(np.maximum(np.diag(covariance), 0.0))


def _prepared(model: Model, evidence: Evidence, responder: Responder) -> Model:
    """Return the model with those inner parameters in the fit that the data determine."""
    members, about = list(model.members), responder.about(model.baseline)
    plain = model.change - freed(members, model.change) if model.change is not None else None
    for k, member in enumerate(members):
        if member.inner or (member.course and not leaves_parameters(member.signature)):
            continue
        scaled = [d for m in members if not m.signature.shape.fixed for d in m.directions]
        laws = [point for m in members for _, point in m.course]
        basis = orthonormal([*scaled, *laws], evidence)
        inner: dict[str, float] = {}
        for name in member.signature.shape.inner:
            value = float(getattr(member.effect, name))
            trial = replace(member, inner={**inner, name: value})
            moved = [*members[:k], trial, *members[k + 1 :]]
            direction = differentiated(k, moved, plain, evidence, about).directions[-1]
            rest = without(direction, basis, evidence)
            if evidence.product(rest, rest) > DETERMINED**2:
                inner[name] = value
                basis += orthonormal([rest], evidence)
        members[k] = replace(member, inner=inner)
    return replace(model, members=tuple(members))


def _with_std(members: Sequence[Member], std: Floats) -> tuple[Member, ...]:
    found, start = [], 0
    for member in members:
        stop = start + len(member.directions)
        found.append(replace(member, std=tuple(float(s) for s in std[start:stop])))
        start = stop
    return tuple(found)


def _stepped(members: Sequence[Member], steps: Floats) -> tuple[Member, ...]:
    """Return the members one step on, the shorter for all the farther a logarithm would go."""
    found, start = [], 0
    strengths = np.cumsum([0, *(len(m.directions) for m in members[:-1])])
    logs = np.delete(steps, strengths)
    # A strength that went all the way beside a time that does not would overshoot.
    steps = steps * min(1.0, FARTHEST / max(float(np.abs(logs).max(initial=0.0)), FARTHEST))
    for member in members:
        step, *others = steps[start : start + len(member.directions)]
        start += len(member.directions)
        inner = {
            name: value * float(np.exp(s))
            for (name, value), s in zip(member.inner.items(), others, strict=True)
        }
        found.append(replace(member, strength=_moved(member, float(step)), inner=inner))
    return tuple(found)


def _moved(member: Member, step: float) -> float:
    """Return the strength one step on; one that has a sign keeps it and shrinks by 4 at most.

    Beyond the bounds of its parameters it would change nothing.
    """
    if member.signature.shape.fixed:
        return member.strength
    strength = member.strength + step
    if member.signature.shape.two_sided:
        return strength
    most = min(10.0 * member.strength, member.signature.shape.most)
    return min(max(strength, 0.25 * member.strength), most)
