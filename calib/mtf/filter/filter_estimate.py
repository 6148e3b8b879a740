"""The paper's method, start to end: harmonics selected, grid, thumbnails, Eq. 6, PSF.

Over many thumbnails, products of different harmonics average out, and Eq. 6 becomes a weighted
mean of the transfers T_h at the harmonics: TF(f) = Σ c_h²·|ŵ(f − f_h)|²·T_h / Σ c_h²·|ŵ(f −
f_h)|² (Nadaraya-Watson). By these weights the harmonics' covariance becomes that of TF. They also
tell what the method costs: TF is T smoothed with |ŵ|², its PSF the true one times the window's
autocorrelation. That bias is not in the uncertainty.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from calib.errors import NotDeterminedError
from calib.mtf.assembly.oversampled import Oversampled, oversampled
from calib.mtf.estimate import Axis, Map, TransferMap, band_limited_psf
from calib.mtf.estimation.harmonic_fit import HarmonicFit
from calib.mtf.filter.overlap import Overlap, harmonics_seen, overlap, weights
from calib.mtf.filter.regressive_filter import RegressiveFilter
from calib.mtf.filter.thumbnails import Thumbnails
from calib.mtf.filter.window import Window

Matrix = NDArray[np.floating]
_PSF_STEPS_PER_PIXEL = 16


@dataclass(frozen=True, eq=False)
class FilterEstimate:
    """What Eq. 6 found; its std is that of noise alone, as in the paper.

    Attributes:
        fit: Whose harmonics are filtered.
        grid: The oversampled images.
        filtering: Eq. 6 for the pattern.
        numerator: Correlation of images and pattern.
        shift_um: Where the pattern lies with the PSF's centroid at 0, in the grating's frame.
    """

    fit: HarmonicFit
    grid: Oversampled
    filtering: RegressiveFilter
    numerator: Map
    shift_um: NDArray[np.floating]

    def at(self, fx_per_um: Axis, fy_per_um: Axis) -> TransferMap:
        """Return the transfer function on a grid of the detector's frame, divided by its T(0)."""
        frequency, shape = self._on_grid(fx_per_um, fy_per_um)
        transfer = self.filtering.transfer(self.numerator, frequency) / self._at_zero
        real, imaginary = self._spread(frequency)
        inside = np.hypot(*frequency.T) <= self._highest * (1 + 1e-9)
        valid = inside & (self.overlap(fx_per_um, fy_per_um).ravel() > Overlap.NONE)
        return TransferMap(
            transfer.reshape(shape), real.reshape(shape), imaginary.reshape(shape),
            valid.reshape(shape),
        )  # fmt: skip

    def overlap(self, fx_per_um: Axis, fy_per_um: Axis) -> NDArray[np.uint8]:
        """Return the case of Fig. 4 on the same grid, [fy, fx]."""
        frequency, shape = self._on_grid(fx_per_um, fy_per_um)
        seen = harmonics_seen(self._window, frequency, self._harmonics)
        return overlap(seen).reshape(shape)

    def psf(self, position_um: Axis) -> tuple[Map, Map]:
        """Return the inverse Fourier transform within the disc, and the std that noise gives it."""
        pitch = self.fit.state.sampling.scan.pitch_um
        step = 1 / (_PSF_STEPS_PER_PIXEL * pitch)
        n = int(np.ceil(self._highest / self.grid.step_um / step))
        axis = step * np.arange(-n, n + 1)
        found = self.at(axis, axis)
        psf = band_limited_psf(np.where(found.valid, found.transfer, 0), axis, position_um)
        frequency, shape = self._on_grid(axis, axis)
        share = self._shares(frequency).reshape(*shape, -1) * found.valid[..., None]
        turned = np.exp(2j * np.pi * np.multiply.outer(position_um, axis)) * step
        spread = np.einsum("yv,xu,vuh->yxh", turned, turned, share, optimize=True)
        plus, minus = np.split(spread / self._at_zero, 2, axis=-1)
        slope = np.concatenate([(plus + minus).real, -(plus - minus).imag], axis=-1)
        std = np.sqrt(np.einsum("yxi,ij,yxj->yx", slope, self._covariance, slope, optimize=True))
        return psf, std

    @property
    def _window(self) -> Window:
        return self.filtering.thumbnails.window

    @cached_property
    def _harmonics(self) -> Matrix:
        """Both of each pair, first those of the fit, cycles per step: (2n, 2)."""
        frequency = self.fit.state.harmonics.frequency_per_um * self.grid.step_um
        return np.vstack([frequency, -frequency])

    @cached_property
    def _highest(self) -> float:
        return float(np.hypot(*self._harmonics.T).max())

    @cached_property
    def _at_zero(self) -> float:
        return float(self.filtering.transfer(self.numerator, np.zeros((1, 2)))[0].real)

    def _on_grid(self, fx: Axis, fy: Axis) -> tuple[Matrix, tuple[int, int]]:
        """Turn a grid of the detector's frame into the grating's, cycles per step: (n, 2)."""
        y, x = np.meshgrid(fy, fx, indexing="ij")
        cos, sin = np.cos(self.grid.tilt_rad), np.sin(self.grid.tilt_rad)
        turned = np.stack([cos * x - sin * y, sin * x + cos * y], axis=-1)
        return turned.reshape(-1, 2) * self.grid.step_um, x.shape

    def _shares(self, frequency: Matrix) -> Matrix:
        """Return the weight of each harmonic in each frequency, (n, 2 n_harmonics)."""
        amplitude = np.abs(np.tile(self.fit.state.harmonics.amplitude, 2))
        share = weights(self._window, frequency, self._harmonics) * amplitude**2
        return np.asarray(share / np.maximum(share.sum(1, keepdims=True), 1e-300))

    @cached_property
    def _covariance(self) -> Matrix:
        """Of the transfers, real parts first, their phases turned to the PSF's centroid."""
        moved = self.shift_um - self.fit.state.sampling.alignment.shift_um
        turn = np.exp(2j * np.pi * (self.fit.state.harmonics.frequency_per_um @ moved))
        n, given = len(turn), self.fit.transfer_covariance
        cos, sin = turn.real, turn.imag
        top = cos[:, None] * given[:n] - sin[:, None] * given[n:]
        turned = np.vstack([top, sin[:, None] * given[:n] + cos[:, None] * given[n:]])
        left = turned[:, :n] * cos - turned[:, n:] * sin
        return np.hstack([left, turned[:, :n] * sin + turned[:, n:] * cos])

    def _spread(self, frequency: Matrix) -> tuple[Map, Map]:
        """Return the std of real and imaginary part."""
        plus, minus = np.split(self._shares(frequency) / self._at_zero, 2, axis=1)
        n = plus.shape[1]
        real = np.einsum(
            "fi,ij,fj->f", plus + minus, self._covariance[:n, :n], plus + minus, optimize=True
        )
        imaginary = np.einsum(
            "fi,ij,fj->f", plus - minus, self._covariance[n:, n:], plus - minus, optimize=True
        )
        return np.sqrt(np.maximum(real, 0)), np.sqrt(np.maximum(imaginary, 0))


def filter_estimate(
    fit: HarmonicFit,
    shift_um: NDArray[np.floating],
    support: int = 3,
    taper: float = 0.5,
) -> FilterEstimate:
    """Apply the paper's method to a fit's harmonics.

    Args:
        fit: Geometry and harmonics.
        shift_um: Where the pattern lies with the PSF's centroid at 0, µm.
        support: The window's FWHM in pixels: 3, or 5.
        taper: Of the Tukey window.

    Raises:
        NotDeterminedError: `grid-too-coarse`, `detector-too-small`, or `no-overlap` where windows
            leave gaps
            between most harmonics (Fig. 4, first case).
    """
    grid = oversampled(fit, shift_um, select_harmonics=True)
    width = support * fit.state.sampling.scan.pitch_um / grid.step_um
    filtering = RegressiveFilter.of(Thumbnails(Window(width, taper), grid.covered), grid.pattern)
    found = FilterEstimate(fit, grid, filtering, filtering.numerator(grid.image), shift_um)
    _check_overlap(found)
    return found


def _check_overlap(found: FilterEstimate) -> None:
    axis = np.linspace(-1, 1, 41) * found._highest / found.grid.step_um  # noqa: SLF001
    inside = np.hypot(*np.meshgrid(axis, axis)) <= axis[-1]
    share = float((found.overlap(axis, axis)[inside] > Overlap.NONE).mean())
    if share < 0.5:
        msg = f"windows of this width make the harmonics overlap in {100 * share:.0f} % of the disc"
        msg += " only: take a grating with more orders or a longer period, or a smaller window"
        raise NotDeterminedError(msg, code="no-overlap")
