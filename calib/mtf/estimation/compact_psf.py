"""The regularised estimate: a PSF on 3 × 3 pixels, fitted to all harmonics with their covariance.

Posterior of a Gaussian process given linear data: mean = K·Aᵀ·(A·K·Aᵀ + C)⁻¹·t, covariance = K −
K·Aᵀ·(…)⁻¹·A·K. Between harmonics, the transfer function is what the support and the prior leave
possible, and its uncertainty says how much that is.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve

from calib.errors import NotDeterminedError
from calib.mtf.estimate import Axis, Map, TransferMap
from calib.mtf.estimation.compact_basis import CompactBasis
from calib.mtf.estimation.psf_prior import PsfPrior, most_probable
from calib.mtf.estimation.quadratic_forms import on_frequencies
from calib.mtf.harmonic_sums import Complex

Matrix = NDArray[np.floating]
_CELLS_PER_PERIOD = 4  # of the pattern's finest
_CELLS_FOR_PRIOR = 3
_LEAST_PERIODS_PER_PIXEL = 2.0  # coarser cells than an eighth make no pixel's edge
_MOST_CELLS = 100  # along a side: their covariance takes 0.8 GB
_MOST_FOR_PRIOR = 300
_MARGIN_PIXELS = 0.5  # a quarter on each side, into which a neighbour's far edge is blurred
_CENTRINGS = 2
_UNIT_STD = 1e-7
_JITTER = 1e-12
_RESOLVED = 0.5


@dataclass(frozen=True, eq=False)
class Harmonic:
    """What was measured: transfers at frequencies of the detector's frame, with their covariance.

    Attributes:
        frequency_per_um: (n, 2), cycles per µm.
        transfer: (n,).
        covariance: Of the real parts, then the imaginary parts, (2n, 2n).
    """

    frequency_per_um: NDArray[np.floating]
    transfer: Complex
    covariance: Matrix

    def moved(self, by_um: NDArray[np.floating]) -> "Harmonic":
        """Return the transfers of a PSF moved by −`by_um`, as its centroid is brought to 0."""
        turn = np.exp(2j * np.pi * (self.frequency_per_um @ by_um))
        rotation = np.block(
            [[np.diag(turn.real), -np.diag(turn.imag)], [np.diag(turn.imag), np.diag(turn.real)]]
        )
        covariance = rotation @ self.covariance @ rotation.T
        return Harmonic(self.frequency_per_um, self.transfer * turn, covariance)

    def thinned(self) -> "Harmonic":
        """Return no more than choosing a prior needs."""
        n = len(self.transfer)
        keep = np.arange(0, n, -(-n // _MOST_FOR_PRIOR))
        both = np.concatenate([keep, n + keep])
        return Harmonic(
            self.frequency_per_um[keep], self.transfer[keep], self.covariance[np.ix_(both, both)]
        )

    def data(self, basis: CompactBasis) -> tuple[Matrix, Matrix, Matrix]:
        """Return design, data and covariance, with T(0) = 1 as the last datum."""
        cells = basis.at(self.frequency_per_um)
        design = np.vstack([cells.real, cells.imag, np.ones(basis.cells**2)])
        seen = np.concatenate([self.transfer.real, self.transfer.imag, [1.0]])
        noise = np.zeros((len(seen), len(seen)))
        noise[:-1, :-1] = self.covariance
        noise[np.diag_indices(len(seen))] += _JITTER
        noise[-1, -1] = _UNIT_STD**2
        return design, seen, noise


@dataclass(frozen=True, eq=False)
class CompactPsf:
    """A PSF on a compact support, and how sure it is.

    Attributes:
        basis: The cells.
        prior: What was assumed.
        share: Of the signal in each cell, (n²,).
        covariance: Of the shares, (n², n²).
        max_frequency_per_um: Up to where harmonics were measured.
        mean_excess: By how much the mean light exceeds the T(0) that the harmonics alone make
            probable, relative to the mean light; and its std.
    """

    basis: CompactBasis
    prior: PsfPrior
    share: Matrix
    covariance: Matrix
    max_frequency_per_um: float
    mean_excess: tuple[float, float]

    @cached_property
    def centroid_um(self) -> NDArray[np.floating]:
        """(x, y) in the detector's frame, µm."""
        return np.asarray(self.basis.places_um @ self.share / self.share.sum())

    @cached_property
    def centroid_covariance(self) -> Matrix:
        """Of the centroid, (2, 2), µm²."""
        return np.asarray(self._moments @ self.covariance @ self._moments.T)

    def at(self, fx_per_um: Axis, fy_per_um: Axis) -> TransferMap:
        """Return the transfer function on a grid, its centroid at 0."""
        along_x, along_y = self.basis.along(fx_per_um), self.basis.along(fy_per_um)
        n = self.basis.cells
        transfer = along_y @ self.share.reshape(n, n) @ along_x.T
        fy, fx = np.meshgrid(fy_per_um, fx_per_um, indexing="ij")
        lever = 2j * np.pi * np.stack([fx, fy]) * transfer
        spread, pseudo = on_frequencies(self.covariance, along_x, along_y, self._moments, lever)
        before = on_frequencies(self.prior.covariance(self.basis), along_x, along_y)[0]
        turn = np.exp(2j * np.pi * (fx * self.centroid_um[0] + fy * self.centroid_um[1]))
        pseudo = (pseudo * turn**2).real
        real, imaginary = (np.sqrt(np.maximum(spread + s * pseudo, 0) / 2) for s in (1, -1))
        inside = np.hypot(fx, fy) <= self.max_frequency_per_um * (1 + 1e-9)
        valid = inside & (spread < _RESOLVED**2 * before)
        return TransferMap(transfer * turn, real, imaginary, valid)

    def psf(self, position_um: Axis) -> tuple[Map, Map]:
        """Return the PSF and its std in the cells that hold the positions; 0 beyond the support."""
        n, cell = self.basis.cells, self.basis.cell_um
        found = []
        for of_cells in (self.share, np.sqrt(np.maximum(np.diag(self.covariance), 0))):
            padded = np.pad(of_cells.reshape(n, n) / cell**2, 1)
            x, y = (
                np.clip(np.floor((position_um + c + n * cell / 2) / cell).astype(int) + 1, 0, n + 1)
                for c in self.centroid_um
            )
            found.append(padded[np.ix_(y, x)])
        return found[0], found[1]

    @cached_property
    def _moments(self) -> Matrix:
        """How the centroid changes with each share, (2, n²)."""
        return np.asarray((self.basis.places_um - self.centroid_um[:, None]) / self.share.sum())


def compact_psf(
    measured: Harmonic, pitch_um: float, max_frequency_per_um: float, support: int = 3
) -> tuple[CompactPsf, NDArray[np.floating]]:
    """Fit a PSF on support × support pixels to the harmonics, its centroid at 0.

    Returns:
        The PSF, and where its centroid was, (x, y) in the detector's frame, µm.

    Raises:
        NotDeterminedError: `pattern-too-fine`.
    """
    side = (support + _MARGIN_PIXELS) * pitch_um
    finest = max(max_frequency_per_um, _LEAST_PERIODS_PER_PIXEL / pitch_um)
    rough, basis = (
        CompactBasis(side, int(np.ceil(n * side * finest)))
        for n in (_CELLS_FOR_PRIOR, _CELLS_PER_PERIOD)
    )
    if basis.cells > _MOST_CELLS:
        msg = f"the pattern reaches {1e3 * max_frequency_per_um:.0f}/mm, too fine for a PSF on"
        msg += f" {support} × {support} pixels of {pitch_um:g} µm: check pitch_um and period_um"
        raise NotDeterminedError(msg, code="pattern-too-fine")
    prior = most_probable(rough, *measured.thinned().data(rough))
    centroid = np.zeros(2)
    for _ in range(_CENTRINGS):
        found = _posterior(basis, prior, measured.moved(centroid), max_frequency_per_um)
        centroid = centroid + found.centroid_um
    return found, centroid


def _posterior(
    basis: CompactBasis, prior: PsfPrior, measured: Harmonic, max_frequency_per_um: float
) -> CompactPsf:
    design, seen, noise = measured.data(basis)
    before = prior.covariance(basis)
    reach = before @ design.T
    solved = cho_factor(design @ reach + noise, lower=True)
    share = reach @ cho_solve(solved, seen)
    covariance = before - reach @ cho_solve(solved, reach.T)
    excess = _left_out(solved, seen)
    return CompactPsf(basis, prior, share, covariance, max_frequency_per_um, excess)


def _left_out(solved: tuple[Matrix, bool], seen: Matrix) -> tuple[float, float]:
    """Return the last datum less what all others predict of it, and the std of that.

    Source: Rasmussen and Williams (2006), equations 5.10 to 5.12.
    """
    unit = np.zeros(len(seen))
    unit[-1] = 1.0
    row = cho_solve(solved, unit)
    return float(row @ seen / row[-1]), float(1 / np.sqrt(row[-1]))
