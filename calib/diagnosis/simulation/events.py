"""Effects made of independent events: what they change grows with how dense the events are.

So few happen in the few lines that are drawn that their statistics would be those of chance. They
are drawn denser than they are, and what they change is scaled back: that is exact for counts of
events, and for moments as long as events are rare.
"""

from dataclasses import dataclass

import numpy as np

from calib.diagnosis.simulation.response import Responder
from calib.diagnosis.simulation.with_values import with_values
from calib.diagnosis.statistics.change import Change
from calib.diagnosis.statistics.rare import RARE
from calib.forward.departure import Departure
from calib.forward.effect import Stage

DENSE = 4e-3
"""Events per sample: none hides another, and hundreds are drawn."""


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
        rare = half.rare.copy()
        if dense.name == "duplicated_lines":
            # Each of their lines is one with that chance: nothing need be counted.
            rare[:, RARE.index("identical_lines")] = density.dense
        known[dense] = Change(
            np.zeros_like(half.means), np.zeros_like(half.onset), pooled, rare,
            nothing, half.codes, np.zeros_like(half.tones), nothing,
        )  # fmt: skip
    return known[dense]
