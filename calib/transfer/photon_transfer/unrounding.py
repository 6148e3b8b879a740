"""Undoing, cell by cell, what rounding to whole codes does to means and variances.

Codes of a signal µ, σ have a variance V(µ, σ) that swings with the phase of µ where σ is below half
a DN, about its average over all phases, V̄(σ) = σ² + 1/12 − B² (`calib.rounding`). The curve is
fitted with V̄. What a cell's own phase does to it is taken off here, V(µ, σ) − V̄(σ), where the
phase is known: where the cell is one pixel, whose mean code tells µ, from 0.25 DN of noise up. What
is seen beyond V(µ, σ) is told in the terms of V̄: taken times by how much less V grows with σ² once
the mean code is given (`calib.rounded_scatter`): a lever of 2.1 at 0.25 DN and of 1.1 at 0.35.

It stays unknown where the mean code hardly moves with µ (below 0.25 DN), and where a cell pools
pixels, each with a phase of its own. There, V̄ is right on average over pixels whose means lie at
all phases, and by how much it may be off is an error of the point that no further exposures
lessen. Means of N pixels that spread by d about a value of any phase have the mean of V − V̄

    mean square  S²·((1 − D)/N + D),    D = exp(−4π²d²),

S² the mean square of V − V̄ of a single pixel. D is that of the first harmonic (of higher ones it
is less) and of a normal spread: 0.7 % of S is left at d = 0.5 DN.

Of a difference of two exposures each exposure is rounded for itself, so that the same holds of
half its mean square. What a line's pixels share moves the phases as well: σ in V counts it, whereas
the curve's V̄ has the pixels' own σ alone, so that the difference of both B² is put right.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from calib.arrays import Columns
from calib.kernels.unrounding import restored
from calib.rounded_scatter import restored_scatter, rounded_scatter
from calib.rounding import (
    INVERTIBLE_SIGMA_DN,
    NEGLIGIBLE_SIGMA_DN,
    mean_square_bias,
    rounded_moments,
    typical_variance,
)
from calib.transfer.photon_transfer.cells import BlockCells
from calib.transfer.photon_transfer.classes import Numbers
from calib.transfer.photon_transfer.dark_level import DarkLevel
from calib.transfer.photon_transfer.noise_line import NoiseLine

NO_SWING_DN = 0.7
"""From here on V lies within 2e-4 of V̄ at any phase."""
_LEAST_SHARE = 0.5
_TINY = 1e-300


@dataclass(frozen=True)
class UnroundedCells:
    """Blocks whose cells are rid of their phases, where those are known.

    Attributes:
        blocks: Means and variances restored.
        unknown: Where the phase stays unknown and matters, (n_blocks, n_cells).
        lever: By how much more σ² errs than a variance, for a phase that is known, as `unknown`.
    """

    blocks: tuple[BlockCells, ...]
    unknown: NDArray[np.bool_]
    lever: NDArray[np.float64]


def unrounded_cells(
    blocks: Sequence[BlockCells],
    dark: DarkLevel,
    line: NoiseLine,
    *,
    tap: Numbers,
    pixels: Columns,
) -> UnroundedCells:
    """Undo what is known of rounding.

    Args:
        blocks: As they were recorded.
        dark: Their dark level.
        line: How much noise there is.
        tap: (n_cells,).
        pixels: Of each cell, (n_cells,).
    """
    done, unknown, levers = [], [], []
    for block in blocks:
        own = line.variance(dark.signal_dn(block, tap), tap)
        sigma = np.sqrt(own + _shared(block, tap))
        swings = sigma < NO_SWING_DN
        known = swings & (pixels == 1) & (sigma >= INVERTIBLE_SIGMA_DN)
        phases = _phases(block, sigma, tap, known)
        swinging = swings.any()
        done.append(_restored(block, np.sqrt(own), sigma, phases) if swinging else block)
        unknown.append(swings & ~np.isfinite(phases.mean_dn))
        levers.append(phases.lever)
    return UnroundedCells(tuple(done), np.array(unknown), np.array(levers))


@dataclass(frozen=True)
class _Phases:
    """What mean codes tell, (n_cells,): µ, NaN where it is not known, n·bias of V(µ), lever."""

    mean_dn: Columns
    bias_dn2: Columns
    lever: Columns


def _phases(
    block: BlockCells, sigma_dn: Columns, tap: Numbers, known: NDArray[np.bool_]
) -> _Phases:
    """Find the means behind the codes.

    The lever is that of a noise over all phases, times what the phases that a tap's cells have
    in this block make of it on average. Where these lie about half a code, the cells tell so
    little that they are as good as unknown.
    """
    n = len(tap)
    at, bias, lever = np.full(n, np.nan), np.zeros(n), np.ones(n)
    if not known.any():
        return _Phases(at, bias, lever)
    sigma, taps = sigma_dn[known], tap[known]
    found, _, _ = restored(
        block.mean_dn[known],
        sigma,
        smallest_dn=INVERTIBLE_SIGMA_DN,
        negligible_dn=NEGLIGIBLE_SIGMA_DN,
    )
    usual, seen = rounded_scatter(sigma).share_of_rise, restored_scatter(found, sigma)
    of_tap = [np.bincount(taps, s) for s in (usual, seen.share_of_rise)]
    share = of_tap[1] / np.maximum(of_tap[0], _TINY)
    enough = (share > _LEAST_SHARE)[taps]
    at[known] = np.where(enough, found, np.nan)
    bias[known] = seen.bias_dn2
    own = np.maximum(share, _LEAST_SHARE)[taps] * usual
    lever[known] = np.where(enough, 1.0 / own, 1.0)
    return _Phases(at, bias, lever)


def _restored(block: BlockCells, own_dn: Columns, sigma_dn: Columns, phases: _Phases) -> BlockCells:
    """Return the block with what its cells' phases do taken off."""
    shared = sigma_dn > own_dn
    variance = block.variance_dn2.copy()
    variance[shared] += mean_square_bias(sigma_dn[shared]) - mean_square_bias(own_dn[shared])
    known = np.isfinite(phases.mean_dn)
    at, sigma = phases.mean_dn[known], sigma_dn[known]
    swing = rounded_moments(at, sigma).variance_dn2 - typical_variance(sigma)
    swing += phases.bias_dn2[known] / max(block.n_exposures, 1)
    expected = typical_variance(own_dn[known])
    off = variance[known] - swing - expected
    variance[known] = expected + phases.lever[known] * off
    mean = np.where(known, phases.mean_dn, block.mean_dn)
    return replace(block, mean_dn=mean, variance_dn2=variance)


def left_factor(mean_dn: Columns, pixels: Columns, unknown: NDArray[np.bool_]) -> float:
    """Return by which factor of S² a class's variance may be off for unknown phases.

    Within cells that pool pixels these spread by √p times what neighbouring cells differ by, p
    pixels each, as white offsets do; a single cell is taken to have pixels at all phases.

    Args:
        mean_dn: Of the class's cells in a block, in their order.
        pixels: Of the same.
        unknown: Of the same.
    """
    if not unknown.any():
        return 0.0
    means, of = mean_dn[unknown], pixels[unknown]
    spread2 = float(np.var(means))
    if of.max() > 1:
        apart = 0.5 * float(np.mean(np.diff(means) ** 2)) if len(means) > 1 else np.inf
        spread2 += float(of.mean()) * apart
    alike = float(np.exp(-4.0 * np.pi**2 * spread2))
    share = float(of.sum() / pixels.sum())
    return share**2 * ((1.0 - alike) / float(of.sum()) + alike)


def _shared(block: BlockCells, tap: Numbers) -> Columns:
    """Return the variance of what a tap shares, DN²; 0 where it is unknown, as then it is in V."""
    shared = np.nan_to_num(block.common_dn2)
    return np.asarray(np.maximum(shared, 0.0)[tap if len(shared) > 1 else np.zeros_like(tap)])
