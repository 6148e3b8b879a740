"""How a variance of rounded samples scatters, averaged over all phases of the mean.

A normal signal µ, σ (DN) has the code k with the probability Φ((k + ½ − µ)/σ) − Φ((k − ½ − µ)/σ).
Where σ is below half a DN their variance V(µ) swings with the phase of µ, and so do their third
and fourth moments. What an estimate of V from n samples needs of that depends on σ alone once it
is averaged over the phases; it is summed up over codes and tabulated here.

Where µ is found back from the mean code (`calib.rounding.unrounded_mean`), V(µ) − V̄ can be taken
off an observed variance; the mean code m brings its own error along, which goes with that of the
variance. With h(m) = V(µ(m)) and κ3 the codes' third cumulant, to first and second order (delta
method: Stuart and Ord, Kendall's Advanced Theory of Statistics, chapter 10)

    n·var(v − h(m)) = n·var(v) + h'²·V − 2·h'·κ3,        n·E(v − h(m)) = −½·h''·V

At a given mean code h grows less with σ² than V̄ does: of two codes the variance is m(1 − m),
whatever σ is. Hence σ² moves by more than it would by V̄, for what is seen of v − h: by one over
the share of dV̄/dσ² that dh/dσ² is, which is near 0 for means at half a code.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

from calib.kernels.rounding import Cells
from calib.rounding import INVERTIBLE_SIGMA_DN

_GRID_DN = 0.0125
_SIGMA_DN = 0.05 + _GRID_DN * np.arange(69)
"""Up to 0.9 DN, where the first harmonic is below 2e-7."""
_PHASES = 64
_PHASE = np.arange(_PHASES) / _PHASES
_STEP_DN = 1e-4


@dataclass(frozen=True)
class RoundedScatter:
    """Averages over all phases of µ; arrays of the shape of σ.

    Attributes:
        variance_spread_dn4: Mean square of V(µ) − V̄, DN⁴.
        fourth_cumulant_dn4: κ4 of the codes.
        restored_dn4: What n·var(v − h(m)) has beyond n·var(v), DN⁴; 0 where µ is not found back.
        share_of_rise: dh/dσ² at a given mean code, by dV̄/dσ²; 1 where µ is not found back.
    """

    variance_spread_dn4: Cells
    fourth_cumulant_dn4: Cells
    restored_dn4: Cells
    share_of_rise: Cells


@dataclass(frozen=True)
class RestoredScatter:
    """What holds of one phase; arrays of the shape of µ and σ.

    Attributes:
        share_of_rise: As in `RoundedScatter`, where it is averaged.
        bias_dn2: n·E(v − h(m)), DN²; 0 where µ is not found back.
    """

    share_of_rise: Cells
    bias_dn2: Cells


def rounded_scatter(sigma_dn: Cells) -> RoundedScatter:
    """Return what the codes' variances scatter by; below 0.05 DN of noise as at 0.05."""
    at, down = _between(sigma_dn)
    rows = ((1.0 - down) * row[at] + down * row[at + 1] for row in _table()[0])
    spread, fourth, restored, share = rows
    inverted = np.asarray(sigma_dn) >= INVERTIBLE_SIGMA_DN
    return RoundedScatter(spread, fourth, inverted * restored, np.where(inverted, share, 1.0))


def restored_scatter(mean_dn: Cells, sigma_dn: Cells) -> RestoredScatter:
    """Return what v − h(m) does at the phases of `mean_dn`.

    Args:
        mean_dn: µ, found back.
        sigma_dn: As `mean_dn`.
    """
    _, shares, biases = _table()
    top, down = _between(sigma_dn)
    column = (mean_dn - np.floor(mean_dn)) * _PHASES
    left = column.astype(np.intp)
    right = column - left
    left, beyond = left % _PHASES, (left + 1) % _PHASES

    def at(table: Cells) -> Cells:
        above = (1.0 - right) * table[top, left] + right * table[top, beyond]
        below = (1.0 - right) * table[top + 1, left] + right * table[top + 1, beyond]
        return (1.0 - down) * above + down * below

    inverted = sigma_dn >= INVERTIBLE_SIGMA_DN
    return RestoredScatter(np.where(inverted, at(shares), 1.0), inverted * at(biases))


def _between(sigma_dn: Cells) -> tuple[NDArray[np.intp], Cells]:
    """Return the row of the table below each σ, and how far it is to the next, 0 to 1."""
    steps = (np.clip(sigma_dn, _SIGMA_DN[0], _SIGMA_DN[-1]) - _SIGMA_DN[0]) / _GRID_DN
    row = np.minimum(steps.astype(np.intp), len(_SIGMA_DN) - 2)
    return row, steps - row


@cache
def _table() -> tuple[Cells, Cells, Cells]:
    """Return four averages at each σ, (4, n_sigma), and shares and biases by σ and phase."""
    averages, shares, biases = zip(*(_at(float(sigma)) for sigma in _SIGMA_DN), strict=True)
    return np.array(averages).T, np.array(shares), np.array(biases)


def _at(sigma: float) -> tuple[tuple[float, ...], Cells, Cells]:
    """Sum over codes at evenly spread phases: exact for harmonics below their number."""
    mean, second, third, fourth = _moments(sigma)
    spread = float(second.var())
    cumulant = float((fourth - 3.0 * second**2).mean())
    if sigma < 0.9 * INVERTIBLE_SIGMA_DN:  # below, the mean code hardly moves with the mean
        return (spread, cumulant, 0.0, 1.0), np.ones(_PHASES), np.zeros(_PHASES)
    gain = 1.0 + _derivative(mean - _PHASE)
    slope = _derivative(second) / gain
    bend = _derivative(slope) / gain
    restored = float((slope**2 * second - 2.0 * slope * third).mean())
    above, below = _moments(sigma + _STEP_DN), _moments(sigma - _STEP_DN)
    rise, shift = above[1] - below[1], above[0] - below[0]
    share = (rise - slope * shift) / rise.mean()
    return (spread, cumulant, restored, float(share.mean())), share, -0.5 * bend * second


def _moments(sigma: float) -> tuple[Cells, Cells, Cells, Cells]:
    """Return the codes' mean and second to fourth central moments at all phases."""
    reach = int(np.ceil(8.0 * sigma)) + 2
    codes = np.arange(-reach, reach + 2)[:, None]
    share = ndtr((codes + 0.5 - _PHASE) / sigma) - ndtr((codes - 0.5 - _PHASE) / sigma)
    mean = (share * codes).sum(axis=0)
    rest = codes - mean
    square = rest * rest
    return (
        mean,
        (share * square).sum(axis=0),
        (share * square * rest).sum(axis=0),
        (share * square * square).sum(axis=0),
    )


def _derivative(periodic: Cells) -> Cells:
    """Return d/dµ of what repeats with every code, by its Fourier series."""
    turns = 2j * np.pi * np.fft.rfftfreq(_PHASES, 1.0 / _PHASES)
    return np.fft.irfft(np.fft.rfft(periodic) * turns, _PHASES)
