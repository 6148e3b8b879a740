"""The orders of a continuously self-imaging grating: the integer points on a circle.

Source: Guérineau, Harchaoui and Primot, Opt. Lett. 26, 411 (2001); Section 1 of the 2018 paper.
"""

from math import isqrt

import numpy as np
from numpy.typing import NDArray

from calib.errors import InputError

Indices = NDArray[np.int64]
"""Integer points (p, q), shape (n, 2)."""


def circle_orders(eta2: int) -> Indices:
    """Return the points with p² + q² = eta2 by rising p, then q: (n, 2).

    >>> len(circle_orders(650)), len(circle_orders(5525))
    (24, 48)
    """
    if eta2 < 1:
        msg = f"eta2 = {eta2} is no squared radius: give a whole number above 0"
        raise InputError(msg, code="no-orders")
    found = []
    for p in range(-isqrt(eta2), isqrt(eta2) + 1):
        q = isqrt(eta2 - p * p)
        if q * q == eta2 - p * p:
            found += [(p, q)] if q == 0 else [(p, -q), (p, q)]
    if not found:
        msg = (
            f"eta2 = {eta2} is no sum of two squares, so that no order lies there: try 650 or 5525"
        )
        raise InputError(msg, code="no-orders")
    return np.array(found, np.int64)
