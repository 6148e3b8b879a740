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
        """Return Σ over pixels and frames of derivative · residual, by unknown."""
        layout, sums = self.state.layout, self.state.sums
        spectrum = (sums.spectra(residual) * sums.frames.conj() * self.state.level[:, None]).sum(0)
        found = np.empty(layout.size)
        found[layout.real], found[layout.imaginary] = 2 * spectrum.real, 2 * spectrum.imag[1:]
        x, y = (residual * each for each in self.along)
        found[layout.scale], found[layout.tilt] = self._geometry(x.sum(0), y.sum(0), slice(None))
        found[layout.of_frames(0)], found[layout.of_frames(1)] = x.sum((1, 2)), y.sum((1, 2))
        brightness = np.einsum("krc,krc->k", residual, self.model) / self.state.level
        found[layout.of_frames(2)] = brightness
        return found

    def by_pixel(self, field: Frames, rows: slice) -> NDArray[np.floating]:
        """Return Σ over frames of derivative · field of each pixel: (n_unknowns, n_pixels).

        Args:
            field: (n_frames, rows, n_columns).
            rows: Which of the detector's rows they are.
        """
        layout, sums = self.state.layout, self.state.sums
        phase = sums.frames.conj().T * self.state.level
        flat = field.reshape(len(field), -1)
        turned = phase.real @ flat + 1j * (phase.imag @ flat)
        place = sums.rows[:, rows, None] * sums.columns[:, None, :]
        turned *= place.reshape(len(turned), -1).conj()
        found = np.empty((layout.size, flat.shape[1]))
        found[layout.real], found[layout.imaginary] = 2 * turned.real, 2 * turned.imag[1:]
        x, y = (field * each[:, rows] for each in self.along)
        scale, tilt = self._by_pixel(x.sum(0), y.sum(0), rows)
        found[layout.scale], found[layout.tilt] = scale.ravel(), tilt.ravel()
        for which, each in enumerate((x, y)):
            found[layout.of_frames(which)] = each.reshape(flat.shape)
        brightness = field * self.model[:, rows] / self.state.level[:, None, None]
        found[layout.of_frames(2)] = brightness.reshape(flat.shape)
        return found

    def _geometry(self, x: NDArray[np.floating], y: NDArray[np.floating], rows: slice) -> Unknowns:
        scale, tilt = self._by_pixel(x, y, rows)
        return np.array([scale.sum(), tilt.sum()])

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
