"""The bench of the 2018 paper, Section 6: grating, stage, tilted detector; exact but for the noise.

Each pixel's value is the sum over all harmonics of amplitude · transfer · exp(2πi f·(x − shift)),
at the pixel's true position: nothing is interpolated.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from calib.mtf.geometry import Alignment, Sampling, Scan
from calib.mtf.grating.grating import Grating
from calib.mtf.harmonic_sums import HarmonicSums
from calib.mtf.simulation.detector import DetectorNoise
from calib.mtf.simulation.response import PixelResponse

Frames = NDArray[np.floating]


@dataclass(frozen=True, eq=False)
class Bench:
    """Everything that decides what is recorded.

    Attributes:
        scan: The nominal geometry.
        grating: What is projected.
        response: The pixel's.
        shape: (n_rows, n_columns).
        alignment: How geometry differs from nominal; stage errors (K, 2).
        detector: Gain, offset and noise.
        level: Each position's light, mean 1, (K,); None for a steady source.
        vibration_um: Standard deviation of the pattern's motion within an exposure, (x, y), µm.
    """

    scan: Scan
    grating: Grating
    response: PixelResponse
    shape: tuple[int, int]
    alignment: Alignment = field(default_factory=Alignment)
    detector: DetectorNoise = field(default_factory=DetectorNoise)
    level: NDArray[np.floating] | None = None
    vibration_um: tuple[float, float] = (0.0, 0.0)

    @property
    def sampling(self) -> Sampling:
        """Where the pixels really lie."""
        return Sampling.whole(self.scan, self.shape, self.alignment)

    def light(self) -> Frames:
        """Return the signal before the detector, mean 1: (K, n_rows, n_columns)."""
        harmonics = self.grating.harmonics
        sums = HarmonicSums(self.sampling, harmonics.frequency_per_um)
        transfer = self.response.transfer(*sums.detector_per_um.T)
        shaken = harmonics.frequency_per_um * np.array(self.vibration_um)
        transfer = transfer * np.exp(-2 * np.pi**2 * (shaken**2).sum(1))
        return sums.images(harmonics.amplitude * transfer, 1.0)

    def record(self, rng: Generator) -> Frames:
        """Return mean images, dark removed, in electrons: (K, n_rows, n_columns)."""
        gain, offset = self.detector.maps(self.shape, rng)
        frames = self.light()
        level = np.ones(len(frames)) if self.level is None else self.level
        for frame, each in zip(frames, level, strict=True):
            frame[:] = self.detector.record(each * frame, gain, offset, rng)
        return frames
