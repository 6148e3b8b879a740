"""The baseline's links with what was fitted to each pixel, in the places of the model's own."""

from dataclasses import dataclass
from operator import mul
from typing import ClassVar

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from calib.arrays import Lines
from calib.forward.conditions import Conditions
from calib.forward.effect import Effect, Stage

Floats = NDArray[np.float64]

BASELINE = (
    "illumination",
    "vignette",
    "responsivity",
    "shot_noise",
    "full_well",
    "read_noise",
    "offset",
    "adc",
)
"""Names of all links of the plain model, in physical order: some are fitted together."""


class FittedLink(Effect):
    """A link whose values are arrays, taken from a recording: no file holds them, none is checked.

    It bears the name, and so has the place, of the catalogue's link for which it stands.
    """

    stochastic: ClassVar[bool] = False

    def __post_init__(self) -> None:
        """Check nothing: what was fitted is what it is."""


@dataclass(frozen=True)
class Light(FittedLink):
    """Radiance of each lamp at its nominal emission."""

    radiance: tuple[float, ...]
    name: ClassVar[str] = "illumination"
    stage: ClassVar[Stage] = Stage.SOURCE

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:  # noqa: ARG002
        """Radiance in and out."""
        return np.asarray(signal + self.seen(at))

    def seen(self, at: Conditions) -> float:
        """Return the radiance of all lamps together."""
        return 0.0 if at.capped else float(sum(map(mul, at.lamps, self.radiance)))


@dataclass(frozen=True)
class Response(FittedLink):
    """Electrons per radiance us of each pixel, (*sample,)."""

    electrons: Floats
    name: ClassVar[str] = "responsivity"
    stage: ClassVar[Stage] = Stage.PHOTONS

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:  # noqa: ARG002
        """Radiance us in, expected electrons out."""
        return np.asarray(signal * self.electrons)


@dataclass(frozen=True)
class GaussianShotNoise(FittedLink):
    """Shot noise in its Gaussian limit: a small change of the charge changes it little."""

    name: ClassVar[str] = "shot_noise"
    stage: ClassVar[Stage] = Stage.CHARGE
    stochastic: ClassVar[bool] = True

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:  # noqa: ARG002
        """Expected electrons in, electrons out."""
        drawn = rng.standard_normal(signal.shape, np.float32)
        return np.asarray(signal + np.sqrt(np.maximum(signal, 0.0)) * drawn)


@dataclass(frozen=True)
class PixelReadNoise(FittedLink):
    """Read noise of each pixel, e-, (*sample,)."""

    std_e: Floats
    name: ClassVar[str] = "read_noise"
    stage: ClassVar[Stage] = Stage.VOLTS
    stochastic: ClassVar[bool] = True

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:  # noqa: ARG002
        """Electrons in and out."""
        return np.asarray(signal + self.std_e * rng.standard_normal(signal.shape, np.float32))


@dataclass(frozen=True)
class PixelGain(FittedLink):
    """System gain of each pixel, DN/e-, (*sample,)."""

    dn_per_e: Floats
    name: ClassVar[str] = "system_gain"
    stage: ClassVar[Stage] = Stage.VOLTS

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:  # noqa: ARG002
        """Electrons in, DN above the offset out."""
        return np.asarray(signal * self.dn_per_e)


@dataclass(frozen=True)
class PixelOffset(FittedLink):
    """Offset of each pixel, DN, (*sample,)."""

    dn: Floats
    name: ClassVar[str] = "offset"
    stage: ClassVar[Stage] = Stage.VOLTS

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:  # noqa: ARG002
        """DN above the offset in, DN out."""
        return np.asarray(signal + self.dn)
