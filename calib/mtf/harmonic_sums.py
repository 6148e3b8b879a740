"""Exact sums over all pixels and frames of harmonics: each is a product of row, column and frame.

The phase of harmonic f at (row, col) in frame k is 2π·[f·(centre + stage_k − shift) + col·u +
row·v], col and row counted from the detector's centre and (u, v) = pitch·f in the detector's
frame. So neither images nor their spectra need a Fourier transform, and no frequency has to lie
on a grid.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from calib.mtf.geometry import Sampling, Vector

Complex = NDArray[np.complex128]
Frames = NDArray[np.floating]
"""Images by stage position, (n_frames, n_rows, n_columns)."""


@dataclass(frozen=True, eq=False)
class HarmonicSums:
    """Harmonics on one sampling.

    Attributes:
        sampling: Where the pixels lie.
        frequency_per_um: (n, 2), in the grating's frame, cycles per µm.
    """

    sampling: Sampling
    frequency_per_um: Vector

    @cached_property
    def detector_per_um(self) -> Vector:
        """The frequencies in the detector's frame, (n, 2), cycles per µm."""
        return self.sampling.to_detector(self.frequency_per_um)

    @cached_property
    def columns(self) -> Complex:
        """exp(2πi·col·u), (n, n_columns)."""
        return self._turns(self.detector_per_um[:, 0], self.sampling.column)

    @cached_property
    def rows(self) -> Complex:
        """exp(2πi·row·v), (n, n_rows)."""
        return self._turns(self.detector_per_um[:, 1], self.sampling.row)

    @cached_property
    def frames(self) -> Complex:
        """exp(2πi·f·(centre + stage − shift)), (n_frames, n)."""
        at = self.sampling.centre_um + self.sampling.stage_um - self.sampling.alignment.shift_um
        turned: Complex = np.exp(2j * np.pi * (at @ self.frequency_per_um.T))
        return turned

    def images(self, amplitude: Complex, mean: float) -> Frames:
        """Return mean + 2·Re Σ amplitude·exp(2πi …) as (n_frames, n_rows, n_columns)."""
        made = np.empty((len(self.frames), self.sampling.n_rows, self.sampling.n_columns))
        across = np.vstack([self.columns.real, self.columns.imag])
        for frame, out in zip(self.frames, made, strict=True):
            down = self.rows.T * (2 * amplitude * frame)
            np.matmul(np.hstack([down.real, -down.imag]), across, out=out)
        made += mean
        return made

    def spectra(self, images: Frames) -> Complex:
        """Return Σ image·exp(−2πi(col·u + row·v)) of each image: (n_frames, n).

        The frames' own phases are not in it.
        """
        return self.spectra_with_moments(images, moments=False)[0]

    def spectra_with_moments(
        self, images: Frames, *, moments: bool = True
    ) -> tuple[Complex, Complex, Complex]:
        """Return the same, and with images multiplied by row and by col: (n_frames, n) each."""
        across = np.hstack([self.columns.real.T, -self.columns.imag.T])
        if moments:
            across = np.hstack([across, across * self.sampling.column[:, None]])
        down, n = self.rows.conj().T, len(self.rows)
        plain, by_row, by_column = np.zeros((3, len(images), n), np.complex128)
        for k, image in enumerate(images):
            lines = image @ across
            turned = down * (lines[:, :n] + 1j * lines[:, n : 2 * n])
            plain[k] = turned.sum(0)
            if moments:
                by_row[k] = self.sampling.row @ turned
                by_column[k] = (down * (lines[:, 2 * n : 3 * n] + 1j * lines[:, 3 * n :])).sum(0)
        return plain, by_row, by_column

    def _turns(self, frequency: Vector, at: Vector) -> Complex:
        pitch = self.sampling.scan.pitch_um
        turned: Complex = np.exp(2j * np.pi * pitch * np.multiply.outer(frequency, at))
        return turned
