"""Effects made of independent events: what they change grows with how dense the events are.

So few happen in the few lines that are drawn that their statistics would be those of chance. They
are drawn denser than they are, and what they change is scaled back: that is exact for counts of
events and shares of codes, and for moments as long as events are rare. Bits that no
comb of code widths resembles are drawn as they stick where that is more often still.
"""

from dataclasses import dataclass

import numpy as np

from calib.diagnosis.baseline.code_counts import CLASSES
from calib.diagnosis.simulation.coded_means import moved_by_codes
from calib.diagnosis.simulation.response import Responder
from calib.diagnosis.simulation.with_values import with_values
from calib.diagnosis.statistics.change import Change
from calib.forward.departure import Departure
from calib.forward.effect import Stage

DENSE = 4e-3
"""Events per sample: none hides another, and hundreds are drawn."""
SMALL_SIGMA = 5.0
"""A bit that moves samples by less than this many times the least noise makes no outliers."""


@dataclass(frozen=True)
class Density:
    """Which parameter tells how dense events are, and what it is where they are dense."""

    parameter: str
    dense: float


def density_of(effect: Departure, responder: Responder) -> Density | None:
    """Return how the effect's events are told; None where it is not made of such."""
    table = responder.chain.table
    if effect.name == "cosmic_rays":
        return Density("per_pixel_s", DENSE / (float(table.exposure_us.max()) * 1e-6))
    if effect.name == "heavy_tailed_noise":
        return Density("share", 2.5 * DENSE)
    if effect.name == "duplicated_lines":
        return Density("probability", 0.25)
    if effect.name == "stuck_bit":
        least = float(np.sqrt(responder.chain.baseline.variance_dn2.mean(axis=(1, 2)).min()))
        moves = 2.0 ** int(getattr(effect, "bit"))  # noqa: B009 - of one kind of effect
        dense = 0.05 if moves < SMALL_SIGMA * least else DENSE
        if moves >= CLASSES:
            dense = max(dense, float(getattr(effect, "probability")))  # noqa: B009 - likewise
        return Density("probability", dense)
    return None


def change_of_events(effect: Departure, density: Density, responder: Responder) -> Change:
    """Return what the effect changes, from where its events are dense."""
    now = float(getattr(effect, density.parameter))
    dense = with_values(effect, {density.parameter: density.dense})
    return _unit(dense, density, responder) * (now / density.dense)


def _unit(dense: Departure, density: Density, responder: Responder) -> Change:
    known = responder.of_events
    if dense not in known:
        draws = [responder.change((dense,), draw, drawn_alone=True) for draw in range(2)]
        half = (draws[0] + draws[1]) * 0.5
        nothing = np.zeros_like(half.pixel_variance)
        # Lines that come twice are left out of all but the count of them.
        pooled = half.pooled * (0.0 if dense.stage >= Stage.TRANSPORT else 1.0)
        known[dense] = Change(
            _means(dense, density, responder), np.zeros_like(half.onset), pooled, half.rare,
            nothing, np.stack([draws[0].codes[0], draws[1].codes[-1]]), np.zeros_like(half.tones),
            nothing,
        )  # fmt: skip
    return known[dense]


def _means(dense: Departure, density: Density, responder: Responder) -> np.ndarray:
    """Return the change of means, DN: samples that stand out are left out of them."""
    chain = responder.chain
    nothing = np.zeros((len(chain.table.blocks), chain.sensor.n_pixels))
    if dense.stage != Stage.CODES:
        return nothing
    always = with_values(dense, {density.parameter: 1.0})
    return density.dense * moved_by_codes(chain, (always,), nothing)
