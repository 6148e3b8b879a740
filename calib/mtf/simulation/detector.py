"""What the detector adds to the light: gain and offset of each pixel, shot and read noise."""

from dataclasses import dataclass

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from calib.errors import InputError

Map = NDArray[np.floating]


@dataclass(frozen=True)
class DetectorNoise:
    """An area detector; signals in electrons, images averaged over `averaged` frames.

    Attributes:
        mean_e: Mean signal of one frame, electrons.
        gain_std: Relative scatter of the pixels' responsivity (PRNU).
        offset_std_e: Scatter of what dark subtraction leaves, electrons.
        read_noise_e: Of one frame, electrons.
        shot_noise: Whether photons come one by one.
        averaged: Frames per stage position.
    """

    mean_e: float = 50_000.0
    gain_std: float = 0.0
    offset_std_e: float = 0.0
    read_noise_e: float = 0.0
    shot_noise: bool = False
    averaged: int = 1

    def __post_init__(self) -> None:
        spreads = (self.gain_std, self.offset_std_e, self.read_noise_e)
        if not self.mean_e > 0 or self.averaged < 1 or min(spreads) < 0:
            msg = "A detector needs a signal above 0, spreads of 0 or more, and one frame or more."
            raise InputError(msg, code="bad-detector")

    def maps(self, shape: tuple[int, int], rng: Generator) -> tuple[Map, Map]:
        """Draw each pixel's gain, mean 1, and offset, electrons."""
        gain = 1 + self.gain_std * rng.normal(size=shape)
        return gain, self.offset_std_e * rng.normal(size=shape)

    def record(self, light: Map, gain: Map, offset_e: Map, rng: Generator) -> Map:
        """Return the mean image of `light` (mean 1), electrons, with noise drawn."""
        electrons = self.mean_e * gain * light
        variance = np.full(light.shape, self.read_noise_e**2 / self.averaged)
        if self.shot_noise:  # a mean of many photons: Gaussian to all that is measured here
            variance += np.maximum(electrons, 0) / self.averaged
        noise = np.sqrt(variance) * rng.normal(size=light.shape)
        image: Map = electrons + offset_e + noise
        return image
