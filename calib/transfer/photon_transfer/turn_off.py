"""Turn-off: the signal from which on the variance falls, and the points below it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.transfer.photon_transfer.points import Points

_FALL_SIGMA = 5.0


@dataclass(frozen=True)
class UsedRange:
    """Which points a tap's fit uses.

    Attributes:
        use: (n_points,).
        turn_off_dn: Mean code at which the variance is highest; NaN where it never falls.
        lowest_dn: Lowest mean code in use.
        highest_dn: Highest mean code in use.
    """

    use: NDArray[np.bool_]
    turn_off_dn: float
    lowest_dn: float
    highest_dn: float


def used_range(points: Points, most_dn: float | None = None) -> UsedRange:
    """Return the points whose codes do not clip, up to the turn-off.

    The variance has turned off where points of higher mean have less of it by five standard
    errors, whatever the cause: clipped codes, full well, anti-blooming. Where codes are spread out
    by clipping alone the turn-off lies where the points' codes begin to clip.

    Args:
        points: Of one tap.
        most_dn: The highest mean code that is to be used; None for all.
    """
    order = np.argsort(points.mean_dn, kind="stable")
    variance = points.variance_dn2[order]
    error = np.sqrt(points.square_factor[order]) * variance
    peak = int(np.nanargmax(variance))
    beyond = slice(peak + 1, None)
    fallen = variance[peak] - variance[beyond] > _FALL_SIGMA * np.hypot(error[peak], error[beyond])
    turn_off = float(points.mean_dn[order][peak]) if fallen.any() else float("nan")
    use = ~points.ends & np.isfinite(points.variance_dn2) & np.isfinite(points.square_factor)
    use &= points.variance_dn2 > 0
    if np.isfinite(turn_off):
        use &= points.mean_dn <= turn_off
    if most_dn is not None:
        use &= points.mean_dn <= most_dn
    means = points.mean_dn[use]
    lowest, highest = (float(means.min()), float(means.max())) if use.any() else (np.nan, np.nan)
    return UsedRange(use, turn_off, lowest, highest)
