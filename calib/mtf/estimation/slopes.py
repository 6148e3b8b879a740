"""How the images change with each unknown: gradients of all pixels at once, or pixel by pixel."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from calib.mtf.estimation.state import State, Unknowns
from calib.mtf.harmonic_sums import Frames


@dataclass(frozen=True, eq=False)
class Slopes:
    """Derivatives of the images at one state. Pixels are counted row by row."""

    state: State

    @cached_property
    def model(self) -> Frames:
        """The images themselves, (n_frames, n_rows, n_columns)."""
        return self._images(self.state.amplitude)

    @cached_property
    def along(self) -> tuple[Frames, Frames]:
        """Their derivatives by x and by y of the stage, per µm."""
        turn = 2j * np.pi * self.state.sums.frequency_per_um
        x, y = (self._images(turn[:, k] * self.state.amplitude) for k in (0, 1))
        return x, y

    def total(self, residual: Frames) -> Unknowns:
        """Return Σ over pixels and frames of derivative · residual, by unknown.

        The images being 2·Re Σ w·E, all of it is in the residual's spectra Σ residual·conj(E).
        """
        layout, sums, level = self.state.layout, self.state.sums, self.state.level
        plain, by_row, by_column = sums.spectra_with_moments(residual)
        turned = (plain * sums.frames.conj() * level[:, None]).sum(0)
        found = np.empty(layout.size)
        found[layout.real], found[layout.imaginary] = 2 * turned.real, 2 * turned.imag[1:]
        weight = self.state.by_frame
        for which, frequency in enumerate(sums.frequency_per_um.T):
            slope = weight * (2j * np.pi * frequency)
            found[layout.of_frames(which)] = 2 * (slope.conj() * plain).sum(1).real
        found[layout.of_frames(2)] = 2 * (weight.conj() * plain).sum(1).real / level
        u, v = 2j * np.pi * self.state.sampling.scan.pitch_um * sums.detector_per_um.T
        size = 1 + self.state.sampling.alignment.scale
        stretched = (weight * u).conj() * by_column + (weight * v).conj() * by_row
        found[layout.scale] = 2 * stretched.sum().real / size
        twisted = (weight * v).conj() * by_column - (weight * u).conj() * by_row
        found[layout.tilt] = 2 * twisted.sum().real
        return found

    def by_pixel(self, field: Frames, rows: slice) -> NDArray[np.float32]:
        """Return Σ over frames of derivative · field of each pixel: (n_unknowns, n_pixels).

        In single precision: what is made of it are covariances.

        Args:
            field: (n_frames, rows, n_columns).
            rows: Which of the detector's rows they are.
        """
        layout, sums = self.state.layout, self.state.sums
        phase = (2 * sums.frames.conj().T * self.state.level).astype(np.complex64)
        flat = field.reshape(len(field), -1).astype(np.float32)
        cos, sin = phase.real.copy() @ flat, phase.imag.copy() @ flat
        down, across = (each.astype(np.complex64) for each in (sums.rows[:, rows], sums.columns))
        place = (down[:, :, None] * across[:, None, :]).reshape(len(cos), -1)
        found = np.empty((layout.size, flat.shape[1]), np.float32)
        found[layout.real] = cos * place.real + sin * place.imag
        found[layout.imaginary] = (sin * place.real - cos * place.imag)[1:]
        x, y = (field * each[:, rows] for each in self.along)
        scale, tilt = self._by_pixel(x.sum(0), y.sum(0), rows)
        found[layout.scale], found[layout.tilt] = scale.ravel(), tilt.ravel()
        for which, each in enumerate((x, y)):
            found[layout.of_frames(which)] = each.reshape(flat.shape)
        brightness = field * self.model[:, rows] / self.state.level[:, None, None]
        found[layout.of_frames(2)] = brightness.reshape(flat.shape)
        return found

    def _by_pixel(
        self, x: NDArray[np.floating], y: NDArray[np.floating], rows: slice
    ) -> tuple[NDArray[np.floating], NDArray[np.floating]]:
        """Return derivatives by scale and tilt from those by x and y of each pixel."""
        sampling = self.state.sampling
        pitch, alignment = sampling.scan.pitch_um, sampling.alignment
        angle = sampling.scan.tilt_rad + alignment.tilt_rad
        row, column = pitch * sampling.row[rows, None], pitch * sampling.column[None, :]
        right = np.cos(angle) * column - np.sin(angle) * row
        up = np.sin(angle) * column + np.cos(angle) * row
        size = 1 + alignment.scale
        return right * x + up * y, size * (right * y - up * x)

    def _images(self, amplitude: NDArray[np.complex128]) -> Frames:
        images = self.state.sums.images(amplitude, 0.0)
        images *= self.state.level[:, None, None]
        return images
