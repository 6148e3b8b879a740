"""What the joint fit found, with its covariance."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from calib.mtf.estimation.sandwich import Sandwich
from calib.mtf.estimation.state import State
from calib.mtf.harmonic_sums import Complex, Frames

Matrix = NDArray[np.floating]


@dataclass(frozen=True, eq=False)
class HarmonicFit:
    """All unknowns, their covariance, and what was seen of pixels and frames.

    Attributes:
        state: The estimates.
        sandwich: The covariance of all unknowns.
        residual: Images less model, gain and offset of each pixel taken off, odd pixels 0.
        noise: Standard deviation of the residual, in the images' unit.
        gain: Of each pixel, less 1, (n_rows, n_columns).
        offset: Of each pixel, in the images' unit.
        gain_std: Scatter of the pixels' gain; 0 where none is seen.
        good: Which pixels entered.
    """

    state: State
    sandwich: Sandwich
    residual: Frames
    noise: float
    gain: Matrix
    offset: Matrix
    gain_std: float
    good: NDArray[np.bool_]

    @property
    def covariance(self) -> Matrix:
        """Of all unknowns, (n_unknowns, n_unknowns)."""
        return self.sandwich.covariance

    @property
    def mean(self) -> float:
        """The images' mean light, in their unit."""
        return float(2 * self.state.amplitude[0].real)

    @cached_property
    def transfer(self) -> Complex:
        """Each harmonic's transfer, its phase about the alignment's shift: (n,)."""
        amplitude = self.state.amplitude
        found: Complex = amplitude[1:] / (2 * amplitude[0].real * self.state.harmonics.amplitude)
        return found

    @cached_property
    def transfer_covariance(self) -> Matrix:
        """Of the transfers' real parts, then their imaginary parts: (2n, 2n)."""
        layout, n = self.state.layout, len(self.transfer)
        slope = np.zeros((2 * n, layout.scale))
        by_own = 1 / (self.mean * self.state.harmonics.amplitude)
        each = np.arange(n)
        for rows, turn in ((slice(0, n), 1), (slice(n, 2 * n), -1j)):
            at = slope[rows]
            at[each, 1 + each] = (by_own * turn).real
            at[each, 1 + n + each] = (by_own * turn * 1j).real
            at[:, 0] = -(self.transfer * turn).real / self.state.amplitude[0].real
        return self.sandwich.of(slope)

    @cached_property
    def detector_per_um(self) -> NDArray[np.floating]:
        """The harmonics' frequencies in the detector's frame, (n, 2), cycles per µm."""
        return self.state.sums.detector_per_um[1:]

    @property
    def scale(self) -> tuple[float, float]:
        """How much the pattern's frequencies exceed the nominal ones, relative, and its std."""
        at = self.state.layout.scale
        return self.state.sampling.alignment.scale, float(np.sqrt(self.covariance[at, at]))

    @property
    def tilt_rad(self) -> tuple[float, float]:
        """The tilt beyond atan(m/n), rad, and its std."""
        at = self.state.layout.tilt
        return self.state.sampling.alignment.tilt_rad, float(np.sqrt(self.covariance[at, at]))

    @property
    def stage_um(self) -> tuple[Matrix, Matrix]:
        """Each frame's error about the steady frames' mean, and its std: (n_frames, 2), µm."""
        found = self.state.sampling.alignment.stage_um
        assert found is not None  # noqa: S101  (a fit always has them)
        spots = [self.state.layout.of_frames(which) for which in (0, 1)]
        std = np.stack([np.sqrt(np.diag(self.covariance)[at]) for at in spots], axis=1)
        return found, std
