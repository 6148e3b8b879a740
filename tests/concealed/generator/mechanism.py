"""What a mechanism is: where it acts, how strong it may be, and what it does."""

from dataclasses import asdict, dataclass
from enum import IntEnum
from typing import Any, ClassVar

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from tests.concealed.generator.scan import Memory, Scan
from tests.concealed.generator.setting import Setting

Pixels = NDArray[Any]
"""(n_samples, n_rows, n_columns), or what broadcasts to it."""


class Stage(IntEnum):
    """Where a mechanism acts, in the order of physics; what it is given and gives back."""

    LAMP = 1
    """Radiance at the source."""
    AMBIENT = 2
    """Radiance at the sensor."""
    EXPOSURE = 3
    """Exposure of each sample, µs."""
    PHOTONS = 4
    """Expected photoelectrons."""
    THERMAL = 5
    """Expected electrons, thermal ones included."""
    COLLECTION = 6
    """Expected electrons in, counted electrons out; at most one mechanism."""
    WELL = 7
    """Counted electrons."""
    TRANSFER = 8
    """Counted electrons."""
    COUPLING = 9
    """Volts in units of electrons, before noise."""
    NOISE = 10
    """The read noise, electrons."""
    VOLTS = 11
    """DN above the offset."""
    OFFSET = 12
    """DN."""
    CONVERSION = 13
    """DN in, as the converter's input; its error is added."""
    QUANTISATION = 14
    """DN in, codes out; at most one mechanism."""
    CODES = 15
    """Codes."""
    TRANSPORT = 16
    """Codes, sample by sample."""


@dataclass(frozen=True)
class Mechanism:
    """One piece of physics that a recording hides.

    Attributes:
        strength: In `unit`; 0 changes nothing.
        shape: One of `shapes` (those that catalogues know) or of `foreign`.
    """

    name: ClassVar[str]
    stage: ClassVar[Stage]
    unit: ClassVar[str]
    shapes: ClassVar[tuple[str, ...]] = ("plain",)
    foreign: ClassVar[tuple[str, ...]] = ()

    strength: float
    shape: str

    @classmethod
    def reach(cls, setting: Setting) -> tuple[float, float]:
        """Return strengths from far below visible to obvious, in `unit`."""
        raise NotImplementedError

    @classmethod
    def draw(cls, strength: float, shape: str, setting: Setting, rng: Generator) -> "Mechanism":
        """Return one of that strength and shape, the rest of its parameters at random."""
        raise NotImplementedError

    @classmethod
    def can_show(cls, setting: Setting) -> bool:
        """Whether sensor and plan could show it at any strength."""
        return True

    def act(self, signal: Pixels, scan: Scan, memory: Memory, rng: Generator) -> Pixels:
        """Return what comes out of its stage; `signal` is left as it is."""
        raise NotImplementedError

    def told(self) -> dict[str, Any]:
        """Return its parameters for the sealed answer."""
        return {name: _plain(value) for name, value in asdict(self).items() if name != "shape"}


def strength_at(reach: tuple[float, float], rung: float) -> float:
    """Return the strength at `rung`, 0 (far below visible) … 1 (obvious), in equal ratios.

    >>> strength_at((1.0, 100.0), 0.5)
    10.0
    """
    low, high = reach
    return float(low * (high / low) ** rung)


def drifting_sign(rng: Generator) -> float:
    """Return +1 or −1."""
    return float(rng.choice([-1.0, 1.0]))


def thinned(counts: Pixels, share: Pixels | float, rng: Generator) -> Pixels:
    """Return how many of `counts` take a chance of `share` each: binomial, never more than all."""
    return np.asarray(rng.binomial(counts, np.clip(share, 0.0, 1.0)))


def _plain(value: Any) -> Any:
    return value.tolist() if isinstance(value, np.ndarray) else value
