"""What effects change in a recording's statistics; what is left to chance is drawn twice."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.recorded.monitor import light_change
from calib.diagnosis.signatures.reproduced import reproduced
from calib.diagnosis.simulation.events import Density, change_of_events, density_of
from calib.diagnosis.simulation.fault_change import change_of_faults, no_change
from calib.diagnosis.simulation.fault_surroundings import Surroundings
from calib.diagnosis.simulation.links_alone import change_of_links
from calib.diagnosis.simulation.response import Responder
from calib.diagnosis.simulation.through_stops import through_stops
from calib.diagnosis.simulation.width_codes import change_by_widths
from calib.diagnosis.simulation.with_values import with_values
from calib.diagnosis.statistics.change import Change
from calib.forward.code_fault import CodeFault
from calib.forward.departure import Departure
from calib.forward.effect import Stage
from calib.forward.effects.adc_dnl import AdcDnl
from calib.forward.effects.catalogue import place_of
from calib.forward.parameter import parameters_of

Floats = NDArray[np.float64]

TOLD = ("pixels", "widths_dn", "rates_e_per_us")
"""Parameters that tell what a pattern's seed would draw."""


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


def needs_two_draws(effect: Departure, responder: Responder) -> bool:
    """Return whether chance has a part in what one draw shows of an effect.

    It has none where nothing is drawn: faults of codes are told from the chance of each code.
    """
    if isinstance(effect, CodeFault):
        return False
    coded = effect.stage >= Stage.CODES
    return coded or responder.chain.has_events(effect) or _other_pattern(effect) != effect


def _simulated(
    effects: tuple[Departure, ...],
    evidence: Evidence,
    responder: Responder,
    *,
    once: bool = False,
    first: Change | None = None,
) -> Change:
    some = (effect for effect in effects if isinstance(effect, CodeFault))
    faults = tuple(sorted(some, key=place_of))
    if faults:
        return _of_faults(faults, effects, evidence, responder, once=once)
    dense = {e: density for e in effects if (density := density_of(e, responder)) is not None}
    if dense:
        return _of_events(dense, effects, evidence, responder, once=once)
    if first is None:
        first = _with_misfit(responder.change(effects), evidence)
        for dnl in (effect for effect in effects if isinstance(effect, AdcDnl)):
            codes = change_by_widths(dnl, responder.chain, evidence)
            first = replace(first, codes=np.stack([codes, codes]))
    found = first
    if not once and any(needs_two_draws(effect, responder) for effect in effects):
        found = _compared(first, effects, evidence, responder)
    return replace(found, monitor=light_change(effects, evidence.table))


def _of_faults(
    faults: tuple[CodeFault, ...],
    effects: tuple[Departure, ...],
    evidence: Evidence,
    responder: Responder,
    *,
    once: bool,
) -> Change:
    """Return what `effects` change, of which `faults` are told from the chance of each code."""
    others = tuple(effect for effect in effects if effect not in faults)
    if others:
        change = change_of(others, evidence, responder, once=once)
    elif responder.plain is not None:
        change = change_of_links(responder.chain.baseline, evidence)
    else:
        change = no_change(evidence)
    surroundings = responder.surroundings.of(
        (others, once), lambda: Surroundings.beside(change, evidence)
    )
    left = through_stops(change, faults, surroundings)
    return _with_misfit(left + change_of_faults(faults, surroundings), evidence)


def _of_events(
    dense: dict[Departure, Density],
    effects: tuple[Departure, ...],
    evidence: Evidence,
    responder: Responder,
    *,
    once: bool,
) -> Change:
    """Return what `effects` change, of which those of events are told where these are dense."""
    parts = [change_of_events(e, density, responder) for e, density in dense.items()]
    others = tuple(e for e in effects if e not in dense)
    if others or responder.plain is not None:
        parts.append(change_of(others, evidence, responder, once=once))
    return _with_misfit(sum(parts[1:], parts[0]), evidence)


def _compared(
    first: Change, effects: tuple[Departure, ...], evidence: Evidence, responder: Responder
) -> Change:
    """Return what a second draw, of another pattern where one is drawn, has in common with one."""
    coded = any(effect.stage >= Stage.CODES for effect in effects)
    others = effects if coded else tuple(_other_pattern(effect) for effect in effects)
    exact = not any(e.stochastic or _other_pattern(e) != e for e in effects)
    second, moved = responder.change(others, draw=1), responder.moved_dn
    sure = _without_chance(effects, evidence, responder)
    found = reproduced(first, second, evidence, moved, sure, exact=exact)
    if others != effects or coded:
        return found
    # Events of single lines are no property of a pixel, however few lines are drawn.
    nothing = np.zeros_like(found.pixel_misfit)
    return replace(found, pixel_misfit=nothing, pixel_variance=nothing)


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
