"""Signatures: the directions in which effects move a recording's statistics."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.evidence.point import Point
from calib.diagnosis.shapes.shape import Shape
from calib.diagnosis.signatures.changes import change_of, needs_two_draws
from calib.diagnosis.simulation.events import density_of
from calib.diagnosis.simulation.response import Responder
from calib.diagnosis.simulation.sampled_lines import is_tone
from calib.diagnosis.statistics.change import Change
from calib.forward.code_fault import CodeFault
from calib.forward.effects.adc_dnl import AdcDnl

Floats = NDArray[np.float64]

AIM = 12.0
"""Strengths are chosen so that signatures are about so many standard deviations long."""
NEAR = 20.0
"""Lengths that differ from that by less than this factor do."""
TRIALS = 3
"""Of strengths."""
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
        grows: Tells `power`.
        beside: Faults of codes beside which it was taken.
    """

    shape: Shape
    strength: float
    change: Change
    point: Point
    length: float
    grows: Callable[[], float] = lambda: 1.0
    beside: tuple[CodeFault, ...] = ()

    @property
    def power(self) -> float:
        """The change grows as this power of the strength; of most shapes, nobody asks."""
        return self.grows()


def signature(
    shape: Shape, evidence: Evidence, responder: Responder, start: float = 1.0
) -> Signature | None:
    """Return the signature at a strength where it is small but clear; None where there is none.

    The search begins at the strength `start`.
    """
    found, tried = _first_look(shape, evidence, responder, start)
    if found.length < FEWEST_SIGMA:
        return None
    if needs_two_draws(found.shape.at(found.strength), responder):
        found = _taken(shape, found.strength, evidence, responder, first=found.change)
    if found.length < FEWEST_SIGMA:
        return None
    if _is_whitened_along_a_curve(shape, responder):
        return _growing_here(found, evidence, responder)
    power = 1.0 if shape.two_sided or shape.fixed else _power(tried)
    return replace(found, grows=lambda: power)


def _first_look(
    shape: Shape, evidence: Evidence, responder: Responder, start: float
) -> tuple[Signature, list[tuple[float, float]]]:
    """Return one draw at about the strength that is wanted, and (strength, length) of all tried."""
    # How often codes are at fault, or how wide, the recording itself has told.
    told = _tells_codes(shape)
    (strength, most), kept = (1.0, np.inf) if told else (start, AIM * NEAR), None
    tried: list[tuple[float, float]] = []
    for _ in range(TRIALS):
        found = _taken(shape, strength, evidence, responder, once=True)
        tried.append((strength, found.length))
        # Rare events do not happen in a few lines where they are as rare as wanted.
        if found.length > AIM / NEAR and (kept is None or found.length < kept.length):
            kept = found
        if shape.fixed or AIM / NEAR < found.length < most:
            break
        power = _power(tried)
        grow = 30.0 if found.length < FEWEST_SIGMA else (AIM / found.length) ** (1 / power)
        strength *= float(np.clip(grow, 1e-4, 1e3))
        if shape.at(strength) == shape.at(tried[-1][0]):
            break
    return (kept if kept is not None and found.length < AIM / NEAR else found), tried


def retaken(
    one: Signature, amplitude: float, evidence: Evidence, responder: Responder
) -> Signature:
    """Return a signature taken where it is as strong as the recording makes it."""
    if one.shape.fixed:
        return one
    ratio = max(abs(amplitude), 1e-6) ** (1.0 / one.power)
    strength = float(np.copysign(min(ratio, 1e3) * one.strength, amplitude))
    again = _taken(one.shape, strength, evidence, responder, beside=one.beside)
    if _is_whitened_along_a_curve(one.shape, responder):
        return _growing_here(again, evidence, responder)
    if one.shape.two_sided:
        return replace(again, grows=one.grows)
    power = _power([(one.strength, one.length), (abs(strength), again.length)])
    return replace(again, grows=lambda: power)


def beside_faults(
    signatures: Sequence[Signature],
    faults: tuple[CodeFault, ...],
    evidence: Evidence,
    responder: Responder,
) -> list[Signature]:
    """Return the signatures, those of faults of codes taken anew beside `faults` that are found.

    Where codes stop there are few for a bit to change, and none that it moves below the stop.
    """

    def anew(one: Signature) -> Signature:
        again = _taken(one.shape, one.strength, evidence, responder, beside=faults)
        return again if one.shape.fixed else _growing_here(again, evidence, responder)

    if not faults:
        return list(signatures)
    return [anew(one) if isinstance(one.shape.template, CodeFault) else one for one in signatures]


def is_of_events(shape: Shape, responder: Responder) -> bool:
    """Return whether the strength of a shape is how dense its events are."""
    return not shape.fixed and density_of(shape.template, responder) is not None


def _tells_codes(shape: Shape) -> bool:
    """Return whether a shape is that of single codes, whose roughness grows as its square."""
    template = shape.template
    return isinstance(template, CodeFault) or (
        isinstance(template, AdcDnl) and bool(template.widths_dn)
    )


def _is_whitened_along_a_curve(shape: Shape, responder: Responder) -> bool:
    """Return whether a shape shows in counts, or in squared amplitudes of a tone."""
    counted = is_of_events(shape, responder) or _tells_codes(shape)
    return not shape.fixed and (counted or is_tone(shape.template))


def _growing_here(one: Signature, evidence: Evidence, responder: Responder) -> Signature:
    """Return the signature with the power with which it grows where it was taken, once asked."""
    shape, strength, beside = one.shape, one.strength, one.beside

    @cache
    def power() -> float:
        more = _taken(shape, 1.2 * strength, evidence, responder, once=True, beside=beside)
        return _power([(strength, one.length), (more.strength, more.length)])

    return replace(one, grows=power)


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
    beside: tuple[CodeFault, ...] = (),
) -> Signature:
    effects = (*beside, shape.at(strength))
    change = change_of(effects, evidence, responder, once=once, first=first)
    point = evidence.point(change)
    if beside:
        without = change_of(beside, evidence, responder)
        change, point = change - without, point - evidence.point(without)
    length = float(np.sqrt(max(evidence.product(point, point), 0.0)))
    return Signature(shape, strength, change, point, length, beside=beside)
