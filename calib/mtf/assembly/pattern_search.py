"""Where a pattern lies, from the phases of its harmonics: a matched filter over its whole cell."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.mtf.grating.harmonics import Harmonics
from calib.mtf.harmonic_sums import Complex

_PER_PERIOD = 8
_NEWTON_STEPS = 6
_NONE = 1e-300  # a frame without any contrast


@dataclass(frozen=True, eq=False)
class PatternSearch:
    """Maximises Re Σ conj(reference)·spectrum·exp(2πi f·x) over shifts x.

    A spectrum of the pattern shifted by x0 holds the factor exp(−2πi f·x0): the sum is largest
    there.

    Attributes:
        harmonics: The pattern's, for its frequencies and its lattice.
        reference: Spectrum of the pattern at shift 0, (n,); 0 where a harmonic is not used.
    """

    harmonics: Harmonics
    reference: Complex

    def best(self, spectra: Complex) -> NDArray[np.floating]:
        """Return the shift nearest to 0 that fits each spectrum best, µm: (n_spectra, 2)."""
        products = spectra * self.reference.conj()
        used = np.abs(self.reference) > 0
        frequency, products = self.harmonics.frequency_per_um[used], products[:, used]
        grid = self._grid(float(np.abs(frequency).max()))
        turned = np.exp(2j * np.pi * (grid @ frequency.T))
        height = products.real @ turned.real.T - products.imag @ turned.imag.T
        start = grid[np.argmax(height, axis=1)]
        found = [
            self.harmonics.shortest(_newton(frequency, *each))
            for each in zip(products, start, strict=True)
        ]
        return np.array(found)

    def agreement(self, spectra: Complex, shifts: NDArray[np.floating]) -> NDArray[np.floating]:
        """Return how well each spectrum agrees at its shift: 1 where it is the reference, (n,)."""
        used = np.abs(self.reference) > 0
        norm = np.linalg.norm(spectra[:, used], axis=1) * np.linalg.norm(self.reference)
        agreement: NDArray[np.floating] = self._overlap(spectra, shifts) / np.maximum(norm, _NONE)
        return agreement

    def strength(self, spectra: Complex, shifts: NDArray[np.floating]) -> NDArray[np.floating]:
        """Return how much of the reference each spectrum holds at its shift, (n,)."""
        power = np.linalg.norm(self.reference) ** 2
        strength: NDArray[np.floating] = self._overlap(spectra, shifts) / np.maximum(power, _NONE)
        return strength

    def _overlap(self, spectra: Complex, shifts: NDArray[np.floating]) -> NDArray[np.floating]:
        turned = np.exp(2j * np.pi * (shifts @ self.harmonics.frequency_per_um.T))
        overlap: NDArray[np.floating] = (spectra * turned * self.reference.conj()).sum(1).real
        return overlap

    def _grid(self, highest: float) -> NDArray[np.floating]:
        """Return shifts that fill the cell, several to the shortest period: (n, 2)."""
        basis = self.harmonics.lattice_um
        counts = np.ceil(np.linalg.norm(basis, axis=1) * highest * _PER_PERIOD).astype(int)
        i, j = np.meshgrid(*(np.arange(n) / n for n in counts))
        return np.asarray(np.stack([i.ravel(), j.ravel()], axis=1) @ basis)


def _newton(
    frequency: NDArray[np.floating], product: Complex, at: NDArray[np.floating]
) -> NDArray[np.floating]:
    """Climb from the best point of the grid to the top."""
    for _ in range(_NEWTON_STEPS):
        turned = product * np.exp(2j * np.pi * (frequency @ at))
        slope = -2 * np.pi * (turned.imag @ frequency)
        curvature = (2 * np.pi) ** 2 * (frequency.T * turned.real) @ frequency
        if np.linalg.eigvalsh(curvature)[0] <= 0:
            break
        at = at + np.linalg.solve(curvature, slope)
    return at
