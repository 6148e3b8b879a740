"""What a photon-transfer line is fitted from: sums over cells, with rounding's part taken off.

With the noise before rounding σ² = K·s + σ_r², V the variance that its codes have, v the one
observed from n lines and V̄ the average of V over all phases of the mean, a cell has the weight
w = (n − 1) / 2V̄², and its variance before rounding is, to first order, σ² + (v − V) / V̄' with
V̄' = dV̄/dσ². `calib.radiometric.estimation.noise_model` makes a line of the sums.
"""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from calib.kernels.rounding import TILE, bias2_and_decay
from calib.kernels.unrounding import undo

Cells = NDArray[np.float64]


class NoiseSums(NamedTuple):
    """Sums over cells; h = w·V̄' are the weights of the next step, y = σ² + (v − V)/V̄'.

    Attributes:
        w: Σ w.
        ws: Σ w·s.
        wss: Σ w·s².
        h: Σ h.
        hs: Σ h·s.
        hss: Σ h·s².
        hy: Σ h·y.
        hsy: Σ h·s·y.
        misfit: Σ w·(v − V)².
    """

    w: float
    ws: float
    wss: float
    h: float
    hs: float
    hss: float
    hy: float
    hsy: float
    misfit: float


def noise_sums(
    cells: tuple[Cells, Cells, Cells, Cells],
    restored_dn: Cells,
    line: tuple[float, float],
    *,
    smallest_dn: float,
    negligible_dn: float,
) -> NoiseSums:
    """Return the sums over cells for the line (K, σ_r²).

    Args:
        cells: Signal s, mean code, observed variance and n − 1, (n_cells,) each.
        restored_dn: The means behind the codes, (n_cells,): where the search for them starts, the
            codes themselves at first, and overwritten with what it finds.
        line: K and σ_r², DN and DN².
        smallest_dn: Noise from which on the mean is found from its code; below, V is V̄.
        negligible_dn: Noise from which on rounding adds 1/12 and nothing else; 1.2 at most.
    """
    sums = np.zeros(9)
    _add(*cells, restored_dn, line, smallest_dn**2, negligible_dn**2, sums)
    return NoiseSums(*(float(each) for each in sums))


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"reassoc", "contract"})
def _add(signal, code, observed, freedom, restored, line, smallest2, negligible2, sums):  # type: ignore[no-untyped-def]  # noqa: PLR0917 - compiled
    buffers = np.empty((4, TILE))
    for left in range(0, signal.size, TILE):
        right = min(left + TILE, signal.size)
        n = right - left
        sigma2, variance, typical, rise = (
            buffers[0, :n], buffers[1, :n], buffers[2, :n], buffers[3, :n],
        )  # fmt: skip
        n_high = 0
        for i in range(n):
            sigma2[i] = line[0] * signal[left + i] + line[1]
            typical[i] = sigma2[i] + 1.0 / 12.0
            variance[i], rise[i] = typical[i], 1.0
            n_high += sigma2[i] >= negligible2
        if n_high < n:
            _rounded(
                code[left:right], sigma2, smallest2, negligible2,
                restored[left:right], variance, typical, rise,
            )  # fmt: skip
        _add_tile(
            signal[left:right], observed[left:right], freedom[left:right],
            sigma2, variance, typical, rise, sums,
        )  # fmt: skip


@njit(cache=True, nogil=True, error_model="numpy")
def _rounded(code, sigma2, smallest2, negligible2, restored, variance, typical, rise):  # type: ignore[no-untyped-def]  # noqa: PLR0917 - compiled
    """Fill V, V̄ and V̄' of a tile, and the means behind its codes."""
    n_low = 0
    for i in range(code.size):
        lost, decay = bias2_and_decay(sigma2[i], negligible2)
        typical[i] -= lost
        rise[i] = 1.0 + decay
        n_low += sigma2[i] < smallest2
    if n_low < code.size:
        undo(code, sigma2, smallest2, negligible2, restored, variance, np.empty(code.size))
    for i in range(code.size):
        variance[i] = typical[i] if sigma2[i] < smallest2 else variance[i]


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"reassoc", "contract"})
def _add_tile(signal, observed, freedom, sigma2, variance, typical, rise, sums):  # type: ignore[no-untyped-def]  # noqa: PLR0917 - compiled
    w0, w1, w2, h0, h1, h2, y0, y1, misfit = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(signal.size):
        s, off = signal[i], observed[i] - variance[i]
        w = 0.5 * freedom[i] / (typical[i] * typical[i])
        h = w * rise[i]
        hy = h * sigma2[i] + w * off
        w0 += w
        w1 += w * s
        w2 += w * s * s
        h0 += h
        h1 += h * s
        h2 += h * s * s
        y0 += hy
        y1 += hy * s
        misfit += w * off * off
    for k, each in enumerate((w0, w1, w2, h0, h1, h2, y0, y1, misfit)):
        sums[k] += each
