"""A quantity of which a data sheet gives a value and bounds."""

from dataclasses import dataclass
from math import inf, sqrt
from typing import Self

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from calib.errors import InputError


@dataclass(frozen=True)
class Bounded:
    """Positive, and somewhere between two bounds, where each value is as likely as another.

    Source: JCGM 100:2008 (GUM), section 4.3.7: a rectangular distribution, type B.

    Attributes:
        value: Nominal.
        low, high: The bounds; both are `value` for what is taken as known.
        unit: Of all three.

    >>> Bounded(1.0, 0.95, 1.05, "mW").std
    0.0288...
    """

    value: float
    low: float
    high: float
    unit: str

    def __post_init__(self) -> None:
        """Raise InputError unless 0 < low <= value <= high, all finite."""
        if not 0 < self.low <= self.value <= self.high < inf:
            raise InputError(
                f"{self.value:g} {self.unit} between {self.low:g} and {self.high:g}: give bounds "
                "above 0 with the value between them.",
                code="bad-bounds",
            )

    @classmethod
    def exact(cls, value: float, unit: str) -> Self:
        """Return what is taken as known."""
        return cls(value, value, value, unit)

    @property
    def std(self) -> float:
        """Standard uncertainty, (high - low) / sqrt(12)."""
        return (self.high - self.low) / sqrt(12.0)

    def drawn(self, n: int, rng: Generator) -> NDArray[np.float64]:
        """Return `n` values from between the bounds, (n,)."""
        return rng.uniform(self.low, self.high, n)
