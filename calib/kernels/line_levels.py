"""Where a line stands as a whole, and which of its samples lie far from there."""

import numpy as np
from numba import njit

SETTLED = 0.1
"""Of a cut, half a standard deviation: a second step that is longer has farther to go."""

MANY = 0.01
"""Of a line's samples: where more are out, its median tells first where it stands."""


@njit(cache=True, nogil=True, fastmath={"reassoc", "contract"})
def deviations(line, reference, cut, now, total, outliers):  # type: ignore[no-untyped-def]  # noqa: PLR0917 - compiled
    """Fill `now`, add it to `total`, and count `outliers`, all (n_columns,), of one line.

    A whole line may be off, after a step of the light: outliers are told from where it stands, and
    are put there.
    """
    n = line.shape[0]
    level = 0.0
    for c in range(n):
        now[c] = float(line[c]) - reference[c]
        level += now[c]
    level, settled = _settled(now, cut, level / n)
    if not settled:
        # A ray of a thousand times the noise draws the mean so far off that all others are out.
        level, _ = _settled(now, cut, np.median(now))
    found = 0
    for c in range(n):
        found += abs(now[c] - level) > cut[c]
    if found > 0:
        # Where many are out to one side they pull the level, and all that is put there with it, by
        # a tenth of the cut for each tenth of the line, until they are no longer out.
        level = _of_the_rest(now, cut, np.median(now) if found > MANY * n else level)
        for c in range(n):
            if abs(now[c] - level) > cut[c]:
                outliers[c] += 1
                now[c] = level
    for c in range(n):
        total[c] += now[c]


@njit(cache=True, nogil=True, fastmath={"reassoc", "contract"})
def _settled(off, cut, level):  # type: ignore[no-untyped-def]  # compiled
    """Return the level to which deviations pull, none by more than its cut, and whether it is."""
    step = 0.0
    for _ in range(2):
        clipped, most = 0.0, 0.0
        for c in range(off.shape[0]):
            clipped += min(max(off[c] - level, -cut[c]), cut[c])
            most += cut[c]
        step = clipped / off.shape[0]
        level += step
    return level, abs(step) <= SETTLED * most / off.shape[0]


@njit(cache=True, nogil=True, fastmath={"reassoc", "contract"})
def _of_the_rest(off, cut, level):  # type: ignore[no-untyped-def]  # compiled
    """Return the mean of the deviations that are within their cuts of the level."""
    total, within = 0.0, 0.0
    for c in range(off.shape[0]):
        near = 1.0 if abs(off[c] - level) <= cut[c] else 0.0
        total += near * off[c]
        within += near
    return total / within if within > 0.0 else level
