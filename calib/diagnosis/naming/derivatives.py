"""What a little more of one effect changes beside the others, by differences."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.naming.model import Member
from calib.diagnosis.signatures.changes import change_of
from calib.diagnosis.signatures.signature import is_of_events
from calib.diagnosis.simulation.fault_surroundings import Surroundings
from calib.diagnosis.simulation.response import Responder
from calib.diagnosis.simulation.sampled_lines import is_tone
from calib.diagnosis.simulation.through_stops import through_stops
from calib.diagnosis.statistics.change import Change
from calib.forward.code_fault import CodeFault

RELATIVE_STEP = 0.1
"""Of a derivative."""
NEAR = 0.1
"""Relative to itself a parameter may move by so much before derivatives are taken anew."""
FAINT = 3.0
"""Standard deviations: an effect that changes less is not found."""

AT_PEAKS = 0.5
"""Of a tone's power."""


def which_moved(
    members: Sequence[Member], derived: Sequence[Member], evidence: Evidence
) -> list[int]:
    """Return the members whose derivatives are to be taken anew: where one has moved, of all.

    Of one that fades, its own: whatever factor it moves by, the others see nothing of it.
    """
    every = list(range(len(members)))
    if not derived:
        return every
    moved = [k for k in every if not _is_near(members[k], derived[k])]
    faint = all(_is_faint(each[k], evidence) for k in moved for each in (members, derived))
    return moved if faint else every


def _is_faint(member: Member, evidence: Evidence) -> bool:
    """Return whether a strength changes less than chance does."""
    (slope, *_), strength = member.directions, member.strength
    return strength**2 * evidence.product(slope, slope) < FAINT**2


def _is_near(now: Member, then: Member) -> bool:
    return abs(now.strength - then.strength) <= NEAR * abs(then.strength) and all(
        abs(np.log(now.inner[name] / value)) <= NEAR for name, value in then.inner.items()
    )


def by_events(member: Member) -> bool:
    """Return whether single events make the effect: a little more of it adds none to a few lines.

    It is compared with none of it then, not with a little more.
    """
    shape = member.signature.shape
    if isinstance(member.effect, CodeFault):
        return False
    return member.effect.stochastic and not shape.two_sided and member.strength > 0


def differentiated(
    k: int,
    members: Sequence[Member],
    change: Change | None,
    evidence: Evidence,
    responder: Responder,
) -> Member:
    """Return member `k` with derivatives by its strength and by its inner logarithms."""
    member = members[k]
    assert change is not None  # noqa: S101 - members change something
    about, faults = change, list[CodeFault]()
    if not isinstance(member.effect, CodeFault):
        faults = [m.effect for m in members if isinstance(m.effect, CodeFault)]
        k, members, change = _before_codes(k, members, change, evidence, responder)
    found = [_by_strength(k, members, change, evidence, responder)]
    for name, value in member.inner.items():
        inner = {**member.inner, name: value * float(np.exp(RELATIVE_STEP))}
        trial = replace(member, inner=inner)
        found.append(_slope(k, trial, RELATIVE_STEP, members, change, evidence, responder))
    if faults:
        surroundings = Surroundings.beside(change, evidence)
        found = [through_stops(each, faults, surroundings) for each in found]
    if not is_tone(member.effect):
        # A peak was chosen for its height: what it tells of slow courses is too much of them.
        found = [replace(each, tones=np.zeros_like(each.tones)) for each in found]
    points = evidence.whitening.derivatives(found, about)
    if member.effect.open_profiles:
        points = [replace(point, means=np.zeros_like(point.means)) for point in points]
    if is_tone(member.effect) and stands_at_peaks(found[0], evidence):
        points = [evidence.whitening.without_shared(point) for point in points]
    return replace(member, changes=tuple(found), directions=tuple(points))


def stands_at_peaks(change: Change, evidence: Evidence) -> bool:
    """Return whether a tone's power stands at peaks of the spectrum, most of it.

    By Parseval's theorem variances and covariances of the lines' means are sums over the spectrum:
    what they say of a tone its peak says, and chance at its frequency, which they have in common,
    counts once. All else that they hold is noise at other frequencies (Whittle, 1953).
    """
    shared = change.pooled[:, evidence.pooled.places["common"]].mean(axis=1)
    # A sine of amplitude a has the mean square a^2 / 2.
    return bool(np.abs(change.tones).sum() > AT_PEAKS * 2.0 * np.abs(shared).sum())


def _by_strength(
    k: int,
    members: Sequence[Member],
    change: Change,
    evidence: Evidence,
    responder: Responder,
) -> Change:
    """Return the derivative by the strength of member `k`; of one without, all that it adds."""
    member = members[k]
    if member.signature.shape.fixed:
        return _alone(k, members, change, evidence, responder)
    if by_events(member):
        alone = _alone(k, members, change, evidence, responder)
        linear = is_of_events(member.signature.shape, responder)
        power = 1.0 if linear else member.signature.power
        return alone * (power / member.strength)
    size = RELATIVE_STEP * (abs(member.strength) or member.signature.strength)
    if member.strength + size > member.signature.shape.most:
        # At the end of its range, as a bit that always sticks, it can only be less.
        size = -size
    trial = replace(member, strength=member.strength + size)
    return _slope(k, trial, size, members, change, evidence, responder)


def _slope(  # noqa: PLR0917 - all that a difference hangs on
    k: int,
    trial: Member,
    step: float,
    members: Sequence[Member],
    change: Change,
    evidence: Evidence,
    responder: Responder,
) -> Change:
    """Return what `trial`, a step from member `k`, changes beyond `change`, by step."""
    effects = tuple(trial.effect if j == k else m.effect for j, m in enumerate(members))
    return (change_of(effects, evidence, responder) - change) * (1.0 / step)


def _before_codes(
    k: int,
    members: Sequence[Member],
    change: Change,
    evidence: Evidence,
    responder: Responder,
) -> tuple[int, Sequence[Member], Change]:
    """Return member `k` among those that are no faults of codes, and what these change.

    What a fault makes of a small step of another effect is small of second order, and takes long,
    but for what a stop leaves of covariances.
    """
    kept = [j for j, m in enumerate(members) if j == k or not isinstance(m.effect, CodeFault)]
    if len(kept) == len(members):
        return k, members, change
    others = [members[j] for j in kept]
    change = change_of(tuple(m.effect for m in others), evidence, responder)
    return kept.index(k), others, change


def _alone(
    k: int,
    members: Sequence[Member],
    change: Change,
    evidence: Evidence,
    responder: Responder,
) -> Change:
    """Return what member `k` adds to the change that the others make without it."""
    others = tuple(m.effect for j, m in enumerate(members) if j != k)
    return change - change_of(others, evidence, responder) if others else change
