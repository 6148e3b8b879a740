"""Where windows make neighbouring harmonics overlap: the three cases of the paper's Fig. 4."""

from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from calib.mtf.filter.window import Window

_BARELY, _FULLY = 0.1, 1.0


class Overlap(IntEnum):
    """What Eq. 6 rests on at a frequency."""

    NONE = 0
    """Less than a tenth of a harmonic within the window's reach: the denominator has a gap."""
    WEAK = 1
    """Less than one harmonic: the value comes from the flanks of its neighbours."""
    STRONG = 2
    """One harmonic or more."""


def harmonics_seen(
    window: Window, frequency: NDArray[np.floating], harmonics: NDArray[np.floating]
) -> NDArray[np.floating]:
    """Return how many harmonics a window sees at each frequency: Σ |ŵ(f − f_h)|²/|ŵ(0)|².

    Args:
        window: The window.
        frequency: (n, 2), cycles per step, in the grid's frame.
        harmonics: (n_harmonics, 2), both of each pair.
    """
    seen = weights(window, frequency, harmonics).sum(1)
    return np.asarray(seen)


def weights(
    window: Window, frequency: NDArray[np.floating], harmonics: NDArray[np.floating]
) -> NDArray[np.floating]:
    """Return |ŵ(f − f_h)|²/|ŵ(0)|², (n, n_harmonics)."""
    away_x, away_y = (np.subtract.outer(frequency[:, k], harmonics[:, k]) for k in (0, 1))
    inside = (np.abs(away_x) < 0.5) & (np.abs(away_y) < 0.5)
    return np.asarray(window.power(away_x) * window.power(away_y) * inside)


def overlap(seen: NDArray[np.floating]) -> NDArray[np.uint8]:
    """Return the case of Fig. 4 at each frequency, from what `harmonics_seen` counts."""
    return ((seen >= _BARELY).astype(np.uint8) + (seen >= _FULLY)).astype(np.uint8)
