"""Sums over thumbnails of products of their spectra, kept as correlations.

Σ_k Î⁽ᵏ⁾·conj(Ô⁽ᵏ⁾) is the Fourier transform of the sum of the thumbnails' cross-correlations,
which is no longer than two windows. From that short array it can be had at any frequency,
exactly: in the detector's frame, too.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray
from scipy import fft

from calib.errors import NotDeterminedError
from calib.mtf.filter.window import Window
from calib.mtf.harmonic_sums import Complex

Map = NDArray[np.floating]
_WORKERS = 2


@dataclass(frozen=True, eq=False)
class Thumbnails:
    """Where windows lie on a grid: side by side at their half maximum, all within what is covered.

    Attributes:
        window: The window.
        covered: Which points of the grid hold an image, [y, x].
        most: How many thumbnails are taken at most; 0 for all.
    """

    window: Window
    covered: NDArray[np.bool_]
    most: int = 0

    @cached_property
    def step(self) -> int:
        """Between neighbouring windows, in steps of the grid: their FWHM."""
        return round(self.window.width)

    @cached_property
    def used(self) -> NDArray[np.bool_]:
        """Which of the lattice of windows are used, (n_down, n_across).

        Raises:
            NotDeterminedError: `detector-too-small` where no window fits.
        """
        size = 2 * self.window.half + 1
        holes = np.pad(np.cumsum(np.cumsum(~self.covered, 0), 1), ((1, 0), (1, 0)))
        if min(self.covered.shape) < size:
            inside = np.zeros((0, 0), bool)
        else:
            inside = (
                holes[size:, size:] - holes[:-size, size:] - holes[size:, :-size]
                + holes[:-size, :-size] == 0
            )[:: self.step, :: self.step]  # fmt: skip
        if not inside.any():
            msg = f"no window of {size} grid steps fits on the detector: record a larger part of it"
            raise NotDeterminedError(msg, code="detector-too-small")
        if self.most:
            inside &= np.cumsum(inside).reshape(inside.shape) <= self.most
        return inside

    @property
    def count(self) -> int:
        """How many there are."""
        return int(self.used.sum())

    @property
    def padded(self) -> int:
        """Side of the arrays of correlations."""
        return int(fft.next_fast_len(4 * self.window.half + 1, real=True))

    def spectra(self, image: Map) -> Iterator[Complex]:
        """Yield each row of windows' spectra, (n_across, padded, padded//2 + 1); 0 where not used.

        Phases count from each window's corner.
        """
        size = 2 * self.window.half + 1
        shape = np.multiply.outer(self.window.values, self.window.values)
        every = self.used
        views = sliding_window_view(image, (size, size))[:: self.step, :: self.step]
        for row, used in zip(views, every, strict=True):
            made = np.zeros((len(used), self.padded, self.padded // 2 + 1), np.complex128)
            if used.any():
                cut = row[used] * shape
                lines = fft.rfft(cut, self.padded, axis=-1, workers=_WORKERS)
                made[used] = fft.fft(lines, self.padded, axis=-2, workers=_WORKERS)
            yield made

    def correlation(self, summed: Complex) -> Map:
        """Return summed spectra as a correlation, [dy, dx], zero shift at [0, 0]."""
        return np.asarray(fft.irfft2(summed, (self.padded, self.padded)))


def at_frequencies(correlation: Map, frequency: NDArray[np.floating]) -> Complex:
    """Return a correlation's Fourier transform at any frequencies.

    Args:
        correlation: [dy, dx], zero shift at [0, 0], negative shifts from the far end.
        frequency: (n, 2), fx and fy in cycles per step.
    """
    at = fft.fftfreq(len(correlation), 1 / len(correlation))
    along_x, along_y = (
        np.exp(-2j * np.pi * np.multiply.outer(frequency[:, k], at)) for k in (0, 1)
    )
    found: Complex = ((along_y @ correlation) * along_x).sum(1)
    return found
