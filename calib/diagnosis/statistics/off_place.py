"""How far a tone lies off the place of the spectrum where it is highest.

Of n lines, a tone d cycles of all of them off a place has the power sinc(d)^2 there, and half a
cycle below and above cos(pi d)^2 / (pi (d + 1/2))^2 and cos(pi d)^2 / (pi (d - 1/2))^2: the roots
of these are as 1/2 - d to 1/2 + d. Noise of the two is independent and makes d scatter by
0.39 / sqrt(S), S the power of the tone over that of the noise, as little as any estimate can (Rife
and Boorstyn, IEEE Transactions on Information Theory 20, 591 (1974)).
"""

import numpy as np

NEAREST = 0.25
"""Farther off, a place half a cycle on would be the highest."""


def off_place(below: float, above: float) -> float:
    """Return how far off it lies, in cycles of all lines.

    Args:
        below: Power half a cycle below, over that of the noise, less what noise has of it.
        above: Half a cycle above.

    >>> round(off_place(np.sinc(0.7) ** 2, np.sinc(0.3) ** 2), 6)
    0.2
    """
    low, high = np.sqrt(max(below, 0.0)), np.sqrt(max(above, 0.0))
    if low + high <= 0.0:
        return 0.0
    return float(np.clip(0.5 * (high - low) / (high + low), -NEAREST, NEAREST))


def places_beside(k: int, along: int, shape: tuple[int, int]) -> tuple[tuple[int, int], ...]:
    """Return the places below and above one of the spectrum, as line and column frequency.

    Beyond the last line frequency comes the first of the next column, in the order of read-out; but
    in the column of what all pixels of a line share its own.
    """
    n, n_columns = shape
    if along == 0:
        return ((k - 1) % n, 0), ((k + 1) % n, 0)
    turns = along * n + (k + n // 2) % n
    found = [divmod(turns + by, n) for by in (-1, 1)]
    low, high = (((k - n // 2) % n, min(max(c, 1), n_columns - 1)) for c, k in found)
    return low, high
