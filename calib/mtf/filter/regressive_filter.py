"""Eq. 6: what fits all thumbnails best, TF = Σ Î⁽ᵏ⁾·conj(Ô⁽ᵏ⁾) / Σ |Ô⁽ᵏ⁾|², and its noise.

Eq. 10, derived. White noise σ_I on the grid enters TF through Σ_k M⁽ᵏ⁾·w(x − x_k), M⁽ᵏ⁾ =
conj(Ô⁽ᵏ⁾)/Σ|Ô|², so that

    σ_TF² = σ_I²·[ E_w·Σ_k |M⁽ᵏ⁾|² + Σ_{k≠l} conj(M⁽ᵏ⁾)·M⁽ˡ⁾·exp(2πi f·(x_l − x_k))·r(x_l − x_k) ],

r being the window's autocorrelation and E_w = r(0) = Σ w² its energy. With n thumbnails that do not
overlap this is σ_TF = σ_I·√E_w·√n·rms(M), and rms(M) falls as 1/n. The paper prints M·√n without
E_w, and the mean of M for its root mean square; neighbouring windows overlap in their flanks, which
the second sum counts.
"""

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from calib.mtf.filter.thumbnails import Thumbnails, at_frequencies
from calib.mtf.harmonic_sums import Complex

Map = NDArray[np.floating]
_NEIGHBOURS = ((0, 1), (1, -1), (1, 0), (1, 1))


@dataclass(frozen=True, eq=False)
class RegressiveFilter:
    """Eq. 6 for one pattern; linear in the image.

    Attributes:
        thumbnails: Where the windows lie.
        spectra: Its thumbnails' spectra, a row of windows each.
    """

    thumbnails: Thumbnails
    spectra: tuple[Complex, ...]

    @classmethod
    def of(cls, thumbnails: Thumbnails, pattern: Map) -> "RegressiveFilter":
        """Prepare for a pattern on the grid, [y, x]."""
        return cls(thumbnails, tuple(thumbnails.spectra(pattern)))

    @cached_property
    def denominator(self) -> Map:
        """Correlation of Σ |Ô⁽ᵏ⁾|²."""
        power = sum((row.real**2 + row.imag**2).sum(0) for row in self.spectra)
        return self.thumbnails.correlation(np.asarray(power))

    @cached_property
    def neighbours(self) -> tuple[Map, ...]:
        """Correlations of Σ conj(Ô⁽ᵏ⁾)·Ô⁽ˡ⁾, l the neighbour of k at each of four sides."""
        sums = np.zeros((4, *self.spectra[0].shape[1:]), np.complex128)
        for row in self.spectra:
            sums[0] += (row[:-1].conj() * row[1:]).sum(0)
        for above, row in pairwise(self.spectra):
            sums[1] += (above[1:].conj() * row[:-1]).sum(0)
            sums[2] += (above.conj() * row).sum(0)
            sums[3] += (above[:-1].conj() * row[1:]).sum(0)
        return tuple(self.thumbnails.correlation(each) for each in sums)

    def numerator(self, image: Map) -> Map:
        """Return the correlation of Σ Î⁽ᵏ⁾·conj(Ô⁽ᵏ⁾)."""
        shape = (self.thumbnails.padded, self.thumbnails.padded // 2 + 1)
        total = np.zeros(shape, np.complex128)
        for seen, known in zip(self.thumbnails.spectra(image), self.spectra, strict=True):
            total += (seen * known.conj()).sum(0)
        return self.thumbnails.correlation(total)

    def transfer(self, numerator: Map, frequency: NDArray[np.floating]) -> Complex:
        """Return Eq. 6 at frequencies (n, 2) of the grid's frame, cycles per step: (n,)."""
        below = at_frequencies(self.denominator, frequency).real
        found: Complex = at_frequencies(numerator, frequency) / below
        return found

    def printed_gain(self, frequency: NDArray[np.floating]) -> Map:
        """Return Eq. 10 as it is printed, √n·mean |M|: for comparison."""
        below = at_frequencies(self.denominator, frequency).real
        mean = np.zeros(len(frequency))
        for row, used in zip(self.spectra, self.thumbnails.used, strict=True):
            for each in row[used]:
                mean += np.abs(at_frequencies(self.thumbnails.correlation(each), frequency))
        return np.asarray(mean / below / np.sqrt(self.thumbnails.count))

    def noise_gain(self, frequency: NDArray[np.floating]) -> Map:
        """Return σ_TF/σ_I at frequencies (n, 2), cycles per step: Eq. 10 as derived above."""
        window, step = self.thumbnails.window, self.thumbnails.step
        below = at_frequencies(self.denominator, frequency).real
        total = window.overlap(0) ** 2 * below
        for (down, across), each in zip(_NEIGHBOURS, self.neighbours, strict=True):
            shared = window.overlap(step * down) * window.overlap(step * across)
            turn = np.exp(-2j * np.pi * step * (frequency @ (across, down)))
            total = total + 2 * shared * (turn * at_frequencies(each, frequency)).real
        gain: Map = np.sqrt(np.maximum(total, 0)) / np.maximum(below, 1e-300)
        return gain
