"""What a fit determines: every harmonic's amplitude, and how the bench differs from nominal.

The image of frame k is level_k · 2·Re Σ a_h·exp(2πi …), h = 0 being the mean with a_0 = mean/2.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from calib.mtf.geometry import Sampling
from calib.mtf.grating.harmonics import Harmonics
from calib.mtf.harmonic_sums import Complex, HarmonicSums

Unknowns = NDArray[np.floating]
"""Re a (n + 1), Im a (n, without the mean's), scale, tilt, then x, y and level of each frame."""


@dataclass(frozen=True)
class Layout:
    """Where which unknown stands, for n harmonics and K frames."""

    n_harmonics: int
    n_frames: int

    @property
    def real(self) -> slice:
        """Real parts of the amplitudes, the mean's first."""
        return slice(0, self.n_harmonics + 1)

    @property
    def imaginary(self) -> slice:
        """Imaginary parts, without the mean's."""
        return slice(self.n_harmonics + 1, 2 * self.n_harmonics + 1)

    @property
    def scale(self) -> int:
        """The pattern's scale."""
        return 2 * self.n_harmonics + 1

    @property
    def tilt(self) -> int:
        """The detector's tilt, rad."""
        return self.scale + 1

    def of_frames(self, which: int) -> slice:
        """Stage errors along x (0) and y (1), µm, and levels (2)."""
        first = self.tilt + 1 + which * self.n_frames
        return slice(first, first + self.n_frames)

    @property
    def size(self) -> int:
        """How many unknowns there are."""
        return self.tilt + 1 + 3 * self.n_frames


@dataclass(frozen=True, eq=False)
class State:
    """A value for every unknown.

    Attributes:
        harmonics: The pattern's.
        sampling: The geometry, its alignment included.
        amplitude: (n + 1,), in the images' unit; the first is half the mean.
        level: Each frame's light relative to the mean, (n_frames,).
        steady: Frames from whose mean stage errors count: all but those far astray, (n_frames,).
    """

    harmonics: Harmonics
    sampling: Sampling
    amplitude: Complex
    level: NDArray[np.floating]
    steady: NDArray[np.bool_]

    @property
    def layout(self) -> Layout:
        """Where its unknowns stand in a vector."""
        return Layout(len(self.harmonics), len(self.level))

    @cached_property
    def sums(self) -> HarmonicSums:
        """Sums over the mean and all harmonics."""
        frequency = np.vstack([np.zeros(2), self.harmonics.frequency_per_um])
        return HarmonicSums(self.sampling, frequency)

    @property
    def by_frame(self) -> Complex:
        """Each frame's amplitudes with its phases and level, (n_frames, n + 1)."""
        return np.asarray(self.sums.frames * self.level[:, None] * self.amplitude)

    def moved(self, step: Unknowns) -> "State":
        """Return the state after a step of a fit."""
        layout, before = self.layout, self.sampling.alignment
        amplitude = self.amplitude + step[layout.real]
        amplitude[1:] += 1j * step[layout.imaginary]
        stage = np.stack([step[layout.of_frames(0)], step[layout.of_frames(1)]], axis=1)
        alignment = replace(
            before,
            scale=before.scale + float(step[layout.scale]),
            tilt_rad=before.tilt_rad + float(step[layout.tilt]),
            stage_um=stage if before.stage_um is None else before.stage_um + stage,
        )
        level = self.level + step[layout.of_frames(2)]
        return replace(
            self, sampling=self.sampling.aligned(alignment), amplitude=amplitude, level=level
        )
