"""What goes round with the lines, in words: the tones of a pattern, its period, its ripple."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.evidence.evidence import Evidence

Floats = NDArray[np.float64]

NEAR = 0.15
"""Of the distance of two frequencies that the lines resolve: a tone that stands out is told
closer than that."""
BY_CHANCE = 0.01
"""So seldom may as many frequencies as that fit a period by chance."""


def rhythm_of(evidence: Evidence) -> str:
    """Return a sentence on the tones of a pattern that lines have in common; empty without one."""
    further = evidence.further_tones
    if not further:
        return ""
    first = [peak for peak in evidence.peaks if peak.cycles_along == 0]
    cycles = [abs(peak.cycles_per_line) for peak in first]
    beside = [tone.cycles_per_line for tone in further]
    square = sum(max(float(np.mean(peak.squared_amplitude_dn2)), 0.0) / 2.0 for peak in first)
    square += sum(tone.square_dn2 for tone in further)
    text = (
        f" Lines go round by {_listed(cycles)} cycles a line, and beside that by {_listed(beside)}:"
        f" a pattern of {np.sqrt(square):.2g} DN (root mean square)"
    )
    period = period_of(beside, int(evidence.n.min()))
    return f"{text} that repeats after {period} lines." if period else f"{text}."


def period_of(cycles_per_line: Sequence[float], lines: int) -> int | None:
    """Return the least number of lines after which all tones repeat; None where none is sure."""
    for period in range(2, lines + 1):
        share = min(2.0 * NEAR * period / lines, 1.0)
        if share ** len(cycles_per_line) > BY_CHANCE / period:
            return None
        turns = np.array(cycles_per_line) * period
        if np.abs(turns - np.round(turns)).max() <= NEAR * period / lines:
            return period
    return None


def _listed(cycles: Sequence[float]) -> str:
    told = [f"{each:.3f}" for each in cycles]
    return told[0] if len(told) == 1 else f"{', '.join(told[:-1])} and {told[-1]}"
