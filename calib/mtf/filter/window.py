"""The window that cuts thumbnails: Tukey's, flat in the middle, with cosine flanks."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from calib.errors import InputError

Vector = NDArray[np.floating]
_TABLE = 4096


@dataclass(frozen=True)
class Window:
    """A separable Tukey window on the oversampled grid.

    Attributes:
        width: Full width at half maximum, in steps of the grid.
        taper: Share of the whole length that the two flanks take, 0 < taper ≤ 1; 1 is Hann's.
    """

    width: float
    taper: float = 0.5

    def __post_init__(self) -> None:
        if not (0 < self.taper <= 1 and self.width >= 2):
            msg = "A window needs a taper above 0 and up to 1, and a width of two steps or more."
            raise InputError(msg, code="bad-window")

    @property
    def length(self) -> float:
        """From end to end, steps: FWHM = (1 − taper/2)·length."""
        return self.width / (1 - self.taper / 2)

    @property
    def half(self) -> int:
        """How many steps from the centre values are above 0."""
        return int(np.ceil(self.length / 2)) - 1

    @cached_property
    def values(self) -> Vector:
        """Along one axis, (2·half + 1,)."""
        away = np.abs(np.arange(-self.half, self.half + 1))
        flank = self.taper * self.length / 2
        beyond = np.clip((away - (self.length / 2 - flank)) / flank, 0, 1)
        return np.asarray(0.5 * (1 + np.cos(np.pi * beyond)))

    def overlap(self, steps: int) -> float:
        """Return Σ w(x)·w(x − steps) along one axis."""
        n = len(self.values) - abs(steps)
        return float(self.values[:n] @ self.values[-n:]) if n > 0 else 0.0

    def power(self, frequency: Vector) -> Vector:
        """Return |FT|² along one axis relative to frequency 0; cycles per step, below 1/2."""
        table = np.linspace(0, 0.5, _TABLE)
        at = np.arange(-self.half, self.half + 1)
        spectrum = np.cos(2 * np.pi * np.multiply.outer(table, at)) @ self.values
        return np.asarray(np.interp(np.abs(frequency), table, (spectrum / spectrum[0]) ** 2))
