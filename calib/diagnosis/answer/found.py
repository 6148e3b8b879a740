"""What was found, as the answer tells it: each effect with its names, place, and parameters."""

from collections.abc import Sequence
from math import sqrt

import numpy as np

from calib.diagnosis.answer.estimate import Estimate
from calib.diagnosis.answer.finding import Finding, NamedCandidate
from calib.diagnosis.answer.locate import locate
from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.naming.contest import Contest
from calib.diagnosis.naming.contribution import contribution
from calib.diagnosis.naming.heldout import HeldOut, HeldOutDeviances
from calib.diagnosis.naming.imperfection import left_by_others
from calib.diagnosis.naming.judgement import Candidate, candidates_of
from calib.diagnosis.naming.model import Member, Model
from calib.forward.parameter import parameters_of


def findings_of(model: Model, contest: Contest, heldout: HeldOutDeviances) -> tuple[Finding, ...]:
    """Return the findings, the most significant first."""
    every = list(range(len(model.members)))
    full = heldout.of(every)
    found = []
    for k, member in enumerate(model.members):
        names = candidates_of(k, model, contest)
        without = heldout.of([j for j in every if j != k])
        widened = sqrt(1.0 + left_by_others(k, model, contest.evidence))
        estimates = estimates_of(member, widened)
        found.append(_finding(member, names, estimates, (without, full), contest.evidence))
    return tuple(sorted(found, key=lambda f: -f.significance_sigma))


def _finding(
    member: Member,
    names: Sequence[Candidate],
    estimates: dict[str, Estimate],
    heldout: tuple[HeldOut, HeldOut],
    evidence: Evidence,
) -> Finding:
    before, after = heldout
    effect = member.effect
    own = contribution(member)
    gain = max((c.gain for c in names if c.effect == effect.name), default=0.0)
    missed = max(before.deviance - before.dof, 1e-9)
    return Finding(
        effect,
        tuple(
            NamedCandidate(c.effect, c.probability, after.deviance + max(gain - c.gain, 0.0))
            for c in names
        ),
        float(np.sqrt(max(gain, 0.0))),
        locate(own, effect.shows_in, effect.depends_on, evidence),
        estimates,
        before.deviance,
        after.deviance,
        float(np.clip((before.deviance - after.deviance) / missed, 0.0, 1.0)),
    )


def estimates_of(member: Member, widened: float = 1.0) -> dict[str, Estimate]:
    """Return the fitted parameters of a member, with their standard uncertainties.

    Args:
        member: The member.
        widened: Factor by which errors of other effects widen the uncertainties of the fit.
    """
    told = parameters_of(type(member.effect))
    found = {}
    for name, unit, _ in member.signature.shape.varied:
        if name in member.inner:
            continue
        value = getattr(member.effect, name)
        if isinstance(unit, tuple):
            largest = int(np.argmax(np.abs(unit)))
            std = widened * abs(unit[largest]) * member.std[0]
            found[name] = Estimate(float(value[largest]), std, told[name].unit)
        else:
            found[name] = Estimate(
                float(value), widened * abs(unit) * member.std[0], told[name].unit
            )
    for name, std in zip(member.inner, member.std[1:], strict=True):
        value = float(getattr(member.effect, name))
        found[name] = Estimate(value, widened * value * std, told[name].unit)
    return found
