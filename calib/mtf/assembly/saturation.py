"""Light that a pixel can no longer count: signals that are equal at the very top.

Noise keeps two signals from being equal, unless they were rounded. What rounding makes equal at the
highest value it makes equal at the second highest about as often, since the pattern's spots are
sharp: few signals lie near the top. Clipping makes signals equal at the top alone. It is looked for
in two ways: over the frames of each pixel, which finds it although a dark image was subtracted, and
over the pixels, which finds spots that touch each pixel in one frame only.
"""

import numpy as np
from numpy.typing import NDArray

from calib.errors import NotDeterminedError
from calib.mtf.harmonic_sums import Frames

_TIMES, _AT_LEAST = 4, 10
_TOLERATED = 0.002  # of the pixels: those are left out
_LEAST_FRAMES = 3
_BRIGHTEST = 0.995

Mask = NDArray[np.bool_]


def saturated_pixels(images: Frames) -> Mask:
    """Return which pixels were clipped in some frames, (n_rows, n_columns).

    Args:
        images: (n_frames, n_rows, n_columns), in any unit. Pixels that are the same in all frames
            are dead or hot, not saturated.
    """
    highest = images.max(axis=0)
    alive = images.min(axis=0) < highest
    if len(images) < _LEAST_FRAMES:
        alive &= False
    return _over_frames(images, highest, alive) | _over_pixels(highest, alive)


def check_saturation(images: Frames) -> None:
    """Refuse a scan whose bright spots are clipped: no harmonic comes out of it unbiased.

    Raises:
        NotDeterminedError: `saturated`.
    """
    share = float(saturated_pixels(images).mean())
    if share > _TOLERATED:
        msg = f"{100 * share:.2g} % of the pixels are saturated where the pattern is bright: record"
        raise NotDeterminedError(f"{msg} again with less light", code="saturated")


def _over_frames(images: Frames, highest: NDArray[np.floating], alive: Mask) -> Mask:
    """Return the pixels that are at their highest value in several frames, if clipping did it."""
    bright = alive & (highest >= 0.5 * (np.quantile(highest, _BRIGHTEST) + np.median(highest)))
    signals, top = images[:, bright], highest[bright]
    at_top = (signals == top).sum(axis=0)
    below = np.where(signals < top, signals, -np.inf)
    at_second = (below == below.max(axis=0, initial=-np.inf)).sum(axis=0)
    found = np.zeros_like(alive)
    if _piled_up(int((at_top - 1).sum()), int((at_second - 1).sum())):
        found[bright] = at_top > 1
    return found


def _over_pixels(highest: NDArray[np.floating], alive: Mask) -> Mask:
    """Return the pixels whose highest value is that of all, if clipping did it."""
    values, counts = np.unique(highest[alive], return_counts=True)
    if len(values) and _piled_up(int(counts[-1] - 1), int(counts[-2:-1].sum())):
        found: Mask = alive & (highest == values[-1])
        return found
    return np.zeros_like(alive)


def _piled_up(at_top: int, below: int) -> bool:
    return at_top > _TIMES * below + _AT_LEAST
