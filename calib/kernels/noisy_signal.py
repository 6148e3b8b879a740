"""From the expected charge of a few lines to DN, with noise that is given, in one pass."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def noisy_signal(  # noqa: PLR0917 - a chain's links
    charge: Floats, shot: Floats, read: Floats, read_e: Floats, gain: Floats, offset_dn: Floats
) -> Floats:
    """Return (charge + sqrt(charge) shot + read_e read) gain + offset, (n_lines, *sample), DN.

    Args:
        charge: Expected electrons, (n_lines, *sample); none below 0 has shot noise.
        shot: Numbers of unit variance, likewise.
        read: Likewise.
        read_e: Read noise, e-, (*sample,).
        gain: System gain, DN/e-, (*sample,).
        offset_dn: Offset, (*sample,).
    """
    found = np.empty(charge.shape)
    n = len(charge)
    _fill(
        charge.reshape(n, -1), shot.reshape(n, -1), read.reshape(n, -1), read_e.ravel(),
        gain.ravel(), offset_dn.ravel(), found.reshape(n, -1),
    )  # fmt: skip
    return found


@njit(cache=True, nogil=True)
def _fill(charge, shot, read, read_e, gain, offset_dn, found):  # type: ignore[no-untyped-def]  # noqa: PLR0917 - compiled
    for n in range(charge.shape[0]):
        for c in range(charge.shape[1]):
            q = charge[n, c]
            noise = np.sqrt(max(q, 0.0)) * shot[n, c] + read_e[c] * read[n, c]
            found[n, c] = (q + noise) * gain[c] + offset_dn[c]
