"""Signatures: the directions in which effects move a recording's statistics."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.evidence.point import Point
from calib.diagnosis.naming.reproduced import reproduced
from calib.diagnosis.naming.shapes import Shape
from calib.diagnosis.recorded.monitor import light_change
from calib.diagnosis.simulation.events import change_of_events, density_of
from calib.diagnosis.simulation.fault_change import change_of_faults, no_change
from calib.diagnosis.simulation.response import Responder
from calib.diagnosis.simulation.sampled_lines import is_tone
from calib.diagnosis.simulation.with_values import with_values
from calib.diagnosis.statistics.change import Change
from calib.forward.code_fault import CodeFault
from calib.forward.departure import Departure
from calib.forward.effect import Stage
from calib.forward.parameter import parameters_of

Floats = NDArray[np.float64]

AIM = 12.0
"""Strengths are chosen so that signatures are about so many standard deviations long."""
NEAR = 20.0
"""Lengths that differ from that by less than this factor do."""
TOLD = ("pixels", "widths_dn")
"""Parameters that tell what a pattern's seed would draw."""
FEWEST_SIGMA = 1e-2
"""A signature shorter than this is rounding."""


@dataclass(frozen=True)
class Signature:
    """What one shape of an effect changes at a strength.

    Attributes:
        shape: The shape.
        strength: Where it was taken.
        change: Of the statistics.
        point: Of the whitened statistics.
        length: Of the point: by how many standard deviations it would be seen.
        power: The change grows as this power of the strength.
    """

    shape: Shape
    strength: float
    change: Change
    point: Point
    length: float
    power: float


def signature(
    shape: Shape, evidence: Evidence, responder: Responder, start: float = 1.0
) -> Signature | None:
    """Return the signature at a strength where it is small but clear; None where there is none.

    The search begins at the strength `start`.
    """
    strength, found = start, None
    tried: list[tuple[float, float]] = []
    kept: Signature | None = None
    for _ in range(3):
        found = _taken(shape, strength, evidence, responder, once=True)
        tried.append((strength, found.length))
        # Rare events do not happen in a few lines where they are as rare as wanted.
        if found.length > AIM / NEAR and (kept is None or found.length < kept.length):
            kept = found
        if shape.fixed or AIM / NEAR < found.length < AIM * NEAR:
            break
        power = _power(tried)
        grow = 30.0 if found.length < FEWEST_SIGMA else (AIM / found.length) ** (1 / power)
        strength *= float(np.clip(grow, 1e-4, 1e3))
        if shape.at(strength) == shape.at(tried[-1][0]):
            break
    if found is not None and found.length < AIM / NEAR and kept is not None:
        found = kept
    if found is None or found.length < FEWEST_SIGMA:
        return None
    if needs_two_draws(found.shape.at(found.strength), responder):
        found = _taken(shape, found.strength, evidence, responder, first=found.change)
    if found.length < FEWEST_SIGMA:
        return None
    power = 1.0 if shape.two_sided or shape.fixed else _power(tried)
    if _is_whitened_along_a_curve(shape, responder):
        power = _power_here(found, evidence, responder)
    return Signature(shape, found.strength, found.change, found.point, found.length, power)


def retaken(
    one: Signature, amplitude: float, evidence: Evidence, responder: Responder
) -> Signature:
    """Return a signature taken where it is as strong as the recording makes it."""
    if one.shape.fixed:
        return one
    ratio = max(abs(amplitude), 1e-6) ** (1.0 / one.power)
    strength = float(np.copysign(min(ratio, 1e3) * one.strength, amplitude))
    again = _taken(one.shape, strength, evidence, responder)
    power = one.power
    if not one.shape.two_sided:
        power = _power([(one.strength, one.length), (abs(strength), again.length)])
    if _is_whitened_along_a_curve(one.shape, responder):
        power = _power_here(again, evidence, responder)
    return replace(again, power=power)


def is_of_events(shape: Shape, responder: Responder) -> bool:
    """Return whether the strength of a shape is how dense its events are."""
    return not shape.fixed and density_of(shape.template, responder) is not None


def _is_whitened_along_a_curve(shape: Shape, responder: Responder) -> bool:
    """Return whether a shape shows in counts, or in squared amplitudes of a tone."""
    counted = is_of_events(shape, responder) or isinstance(shape.template, CodeFault)
    return not shape.fixed and (counted or is_tone(shape.template))


def _power_here(one: Signature, evidence: Evidence, responder: Responder) -> float:
    """Return the power of the strength with which a signature grows where it was taken."""
    more = _taken(one.shape, 1.2 * one.strength, evidence, responder, once=True)
    return _power([(one.strength, one.length), (more.strength, more.length)])


def _power(tried: list[tuple[float, float]]) -> float:
    """Return the power of the strength with which the length grows, told by the last two."""
    if len(tried) < 2 or min(length for _, length in tried) <= 0:
        return 1.0
    (s0, l0), (s1, l1) = tried[-2:]
    return float(np.clip(np.log(l1 / l0) / np.log(s1 / s0), 0.5, 2.0)) if s0 != s1 else 1.0


def _taken(
    shape: Shape,
    strength: float,
    evidence: Evidence,
    responder: Responder,
    *,
    once: bool = False,
    first: Change | None = None,
) -> Signature:
    change = change_of((shape.at(strength),), evidence, responder, once=once, first=first)
    point = evidence.point(change)
    length = float(np.sqrt(max(evidence.product(point, point), 0.0)))
    return Signature(shape, strength, change, point, length, 1.0)


def needs_two_draws(effect: Departure, responder: Responder) -> bool:
    """Return whether chance has a part in what one draw shows of an effect."""
    coded = effect.stage >= Stage.CODES and not isinstance(effect, CodeFault)
    return coded or responder.chain.has_events(effect) or _other_pattern(effect) != effect


def change_of(
    effects: tuple[Departure, ...],
    evidence: Evidence,
    responder: Responder,
    *,
    once: bool = False,
    first: Change | None = None,
) -> Change:
    """Return what effects change; what is left to chance is taken twice, and compared.

    Not so where `once`, which tells the size of a change and no more; what that gave may be told
    as `first`.
    """
    if once or first is not None:
        return _simulated(effects, evidence, responder, once=once, first=first)
    # One responder serves one evidence.
    key = (effects, responder.links_key)
    return responder.known.of(key, lambda: _simulated(effects, evidence, responder))


def _simulated(
    effects: tuple[Departure, ...],
    evidence: Evidence,
    responder: Responder,
    *,
    once: bool = False,
    first: Change | None = None,
) -> Change:
    faults = tuple(effect for effect in effects if isinstance(effect, CodeFault))
    if faults:
        others = tuple(effect for effect in effects if effect not in faults)
        change = (
            change_of(others, evidence, responder, once=once)
            if (others or responder.plain is not None)
            else no_change(evidence)
        )
        return _with_misfit(change + change_of_faults(faults, change, evidence), evidence)
    dense = {e: density for e in effects if (density := density_of(e, responder)) is not None}
    if dense:
        parts = [change_of_events(e, density, responder) for e, density in dense.items()]
        others = tuple(e for e in effects if e not in dense)
        if others or responder.plain is not None:
            parts.append(change_of(others, evidence, responder, once=once))
        return _with_misfit(sum(parts[1:], parts[0]), evidence)
    coded = any(effect.stage >= Stage.CODES for effect in effects)
    if first is None:
        first = _with_misfit(responder.change(effects), evidence)
    others = effects if coded else tuple(_other_pattern(effect) for effect in effects)
    if not once and any(needs_two_draws(effect, responder) for effect in effects):
        exact = not any(e.stochastic or _other_pattern(e) != e for e in effects)
        second, moved = responder.change(others, draw=1), responder.moved_dn
        sure = _without_chance(effects, evidence, responder)
        first = reproduced(first, second, evidence, moved, sure, exact=exact)
        if others == effects and not coded:
            # Events of single lines are no property of a pixel, however few lines are drawn.
            nothing = np.zeros_like(first.pixel_misfit)
            first = replace(first, pixel_misfit=nothing, pixel_variance=nothing)
    return replace(first, monitor=light_change(effects, evidence.table))


def _without_chance(
    effects: tuple[Departure, ...], evidence: Evidence, responder: Responder
) -> Floats:
    """Return what links that moved, and effects in which chance has no part, do to the means."""
    sure = tuple(effect for effect in effects if not needs_two_draws(effect, responder))
    return change_of(sure, evidence, responder).means if sure else responder.moved_dn


def _with_misfit(change: Change, evidence: Evidence) -> Change:
    """Return the change with what it does to single pixels, whose places nobody knows."""
    misfit = evidence.misfit(change.means, observed=False)
    return replace(change, pixel_misfit=misfit)


def _other_pattern(effect: Departure) -> Departure:
    """Return the effect on another sensor of its kind: the places of its pixels are unknown.

    Where they are told, it is the same.
    """
    told = parameters_of(type(effect))
    if any(getattr(effect, name) for name in TOLD if name in told):
        return effect
    seeds = {n: getattr(effect, n) + 1 for n in parameters_of(type(effect)) if n.endswith("seed")}
    return with_values(effect, seeds) if seeds else effect
