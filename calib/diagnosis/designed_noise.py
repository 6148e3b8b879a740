"""A generator that answers links with designed noise: what is linear in it has exact moments.

Where a link splits counts, it gets mean and deviation of what it asks for (`Moments`); the normal
numbers behind these are designed for the few lines that are simulated. Only what cannot be answered
so is left to chance: single events, which a link asks for one by one.
"""

from typing import Any

import numpy as np
from numpy.random import PCG64, Generator, default_rng
from numpy.typing import ArrayLike, NDArray

from calib.diagnosis.designed_normals import designed_normals, designed_sequence
from calib.forward.moments import Moments

Floats = NDArray[np.float64]


_SHARED = PCG64(0)
"""Nothing is drawn from it: seeding one for each block would take longer than most effects do."""


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
        super().__init__(_SHARED, noise=noise)
        self._seed, self._shape, self._which, self._source = seed, shape, which, source
        self._size = noise
        self._asked = 0
        self._lines: Floats | None = None
        self._chance: Generator | None = None
        self.shared = False

    @property
    def events(self) -> bool:
        """Whether anything was left to chance."""
        return self._chance is not None

    @property
    def chance(self) -> Generator:
        """What draws events."""
        if self._chance is None:
            self._chance = default_rng(self._seed)
        return self._chance

    def poisson(self, lam: ArrayLike = 1.0, size: Any = None) -> Any:
        """Return smooth numbers for pixels; single ones, of events, are drawn."""
        if np.ndim(lam) == 0 and size is None:
            return self.chance.poisson(float(np.asarray(lam)))
        return super().poisson(lam, size)

    def binomial(self, n: ArrayLike, p: ArrayLike, size: Any = None) -> Any:
        """Return smooth numbers; none comes of less than nothing."""
        return super().binomial(np.maximum(n, 0.0), p, size)

    def standard_normal(self, size: Any = None, *_: Any, **__: Any) -> Any:
        """Return designed numbers for all lines, for one line, or one number a line.

        After events, and of any other shape, they are drawn.
        """
        shape = size if isinstance(size, tuple) else () if size is None else (int(size),)
        n, one_a_line = self._shape[0], {self._shape[:1], (*self._shape[:-1], 1)}
        if self.events or shape not in {self._shape, self._shape[1:], *one_a_line}:
            return self.chance.standard_normal(size)
        self.shared |= shape in one_a_line
        if not self._size:
            return np.zeros(shape)
        if n < 2:
            return self._size * default_rng(self._seed).standard_normal(shape)
        if shape == self._shape[1:]:
            return self._size * self._next_line()
        self._asked += 1
        if np.prod(shape) == n:
            return self._size * designed_sequence(n, self._which + self._asked).reshape(shape)
        return self._size * self._designed(shape[1:]).reshape(shape)

    def random(self, *asked: Any, **how: Any) -> Any:
        """Return uniform numbers, which tell events."""
        return self.chance.random(*asked, **how)

    def integers(self, *asked: Any, **how: Any) -> Any:
        """Return whole numbers, likewise."""
        return self.chance.integers(*asked, **how)

    def geometric(self, *asked: Any, **how: Any) -> Any:
        """Return lengths, likewise."""
        return self.chance.geometric(*asked, **how)

    def choice(self, *asked: Any, **how: Any) -> Any:
        """Return choices, likewise."""
        return self.chance.choice(*asked, **how)

    def uniform(self, *asked: Any, **how: Any) -> Any:
        """Return uniform numbers, likewise."""
        return self.chance.uniform(*asked, **how)

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
        super().__init__(_SHARED, noise=1.0)
        self._normals = normals

    def standard_normal(self, *_: Any, **__: Any) -> Any:
        """Return what was prepared."""
        return self._normals
