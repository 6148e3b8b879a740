"""A generator that answers links with designed noise: what is linear in it has exact moments.

Where a link splits counts, it gets mean and deviation of what it asks for (`Moments`); the normal
numbers behind these are designed for the few lines that are simulated. Only what cannot be answered
so is left to chance: single events, which a link asks for one by one.
"""

from typing import Any

import numpy as np
from numpy.random import Generator
from numpy.typing import ArrayLike, NDArray

from calib.diagnosis.designed_normals import designed_normals, designed_sequence
from calib.forward.moments import Moments

Floats = NDArray[np.float64]


class DesignedNoise(Moments):
    """Answers for the lines of one stretch of one block.

    Attributes:
        events: Whether anything was left to chance.
        shared: Whether all of a line got one number: its products with what the line's pixels
            have in common by chance are no small matter, and change sign with `noise`.
    """

    def __init__(
        self, seed: list[int], shape: tuple[int, ...], which: int, source: int, *, noise: float
    ) -> None:
        """Answer for lines of `shape`, (n_lines, *sample); see `designed_normals` for the rest.

        `noise` is 1, or -1 for the opposite numbers, or 0 for expectations.
        """
        super().__init__(seed, noise=noise)
        self._shape, self._which, self._source, self._size = shape, which, source, noise
        self._asked = 0
        self._lines: Floats | None = None
        self.events = self.shared = False

    def poisson(self, lam: ArrayLike = 1.0, size: Any = None) -> Any:
        """Return smooth numbers for pixels; single ones, of events, are drawn."""
        if np.ndim(lam) == 0 and size is None:
            self.events = True
            return Generator.poisson(self, float(np.asarray(lam)))
        return super().poisson(lam, size)

    def binomial(self, n: ArrayLike, p: ArrayLike, size: Any = None) -> Any:
        """Return smooth numbers; none comes of less than nothing."""
        return super().binomial(np.maximum(n, 0.0), p, size)

    def standard_normal(self, size: Any = None, *_: Any, **__: Any) -> Any:
        """Return designed numbers for all lines, for one line, or one number a line.

        After events, and of any other shape, they are drawn.
        """
        shape = size if isinstance(size, tuple) else () if size is None else (int(size),)
        n = self._shape[0]
        known = {self._shape, self._shape[1:], self._shape[:1], self._row}
        if self.events or shape not in known:
            return Generator.standard_normal(self, size)
        self.shared |= shape in {self._shape[:1], self._row}
        if not self._size:
            return np.zeros(shape)
        if n < 2:
            return self._size * Generator.standard_normal(self, shape)
        if shape == self._shape[1:]:
            return self._size * self._next_line()
        self._asked += 1
        if np.prod(shape) == n:
            return self._size * designed_sequence(n, self._which + self._asked).reshape(shape)
        return self._size * self._designed(shape[1:]).reshape(shape)

    def random(self, *asked: Any, **how: Any) -> Any:
        """Return uniform numbers, which tell events."""
        self.events = True
        return super().random(*asked, **how)

    @property
    def _row(self) -> tuple[int, ...]:
        return (*self._shape[:-1], 1)

    def _next_line(self) -> Floats:
        k = self._asked % self._shape[0]
        if k == 0 or self._lines is None:
            self._lines = self._designed(self._shape[1:])
        self._asked += 1
        return np.asarray(self._lines[k])

    def _designed(self, sample: tuple[int, ...]) -> Floats:
        which = self._which + 3 * (self._asked // self._shape[0])
        return designed_normals(self._shape[0], sample, which, self._source)


class Prepared(Moments):
    """Answers links of the baseline for lines of many blocks at once, with what was prepared."""

    def __init__(self, normals: Floats) -> None:
        """Answer with `normals`, (n_lines, *sample)."""
        super().__init__(0, noise=1.0)
        self._normals = normals

    def standard_normal(self, *_: Any, **__: Any) -> Any:
        """Return what was prepared."""
        return self._normals
