"""A generator that answers links with designed noise: what is linear in it has exact moments.

Where a link splits counts, it gets mean and deviation of what it asks for (`Moments`); the normal
numbers behind these are designed for the few lines that are simulated. Only what cannot be answered
so is left to chance: single events, which a link asks for one by one.
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.random import PCG64, Generator, default_rng
from numpy.typing import ArrayLike, NDArray

from calib.diagnosis.simulation.designed_normals import WIDTH, designed_normals, designed_sequences
from calib.forward.moments import Moments

Floats = NDArray[np.float64]

MOST_TAPS = 4
"""Of a line that have numbers of their own."""
_SHARED = PCG64(0)
"""Nothing is drawn from it: seeding one for each block would take longer than most effects do."""


class DesignedNoise(Moments):
    """Answers for lines of one block, or of several with as many lines each."""

    def __init__(
        self,
        seed: list[int],
        shape: tuple[int, ...],
        which: Sequence[int],
        source: int,
        *,
        noise: float,
    ) -> None:
        """Answer for lines of `shape`, (n_lines, *sample).

        Args:
            seed: Of events.
            shape: Of the signal.
            which: The number of each block; see `designed_normals`, also for the source.
            source: Of noise.
            noise: 1, or -1 for the opposite numbers, or 0 for expectations.
        """
        super().__init__(_SHARED, noise=noise)
        self._seed, self._shape, self._which, self._source = seed, shape, which, source
        self._size, self._n = noise, shape[0] // len(which)
        self._arrays = 0
        # What is asked for line by line, or column by column, by the share that is asked for.
        self._share: object = None
        self._given: dict[object, tuple[int, Floats]] = {}
        self._chance: Generator | None = None

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
        self._share = None
        return super().poisson(lam, size)

    def binomial(self, n: ArrayLike, p: ArrayLike, size: Any = None) -> Any:
        """Return smooth numbers; none comes of less than nothing."""
        self.asked_for(p)
        return super().binomial(np.maximum(n, 0.0), p, size)

    def asked_for(self, share: ArrayLike) -> None:
        """Take the next numbers from those that belong to a share."""
        self._share = float(np.asarray(share)) if np.ndim(share) == 0 else None

    def standard_normal(self, size: Any = None, *_: Any, **__: Any) -> Any:
        """Return designed numbers for all lines, for one line, or a few of each row or line.

        After events, and of any other shape, they are drawn.
        """
        shape = size if isinstance(size, tuple) else () if size is None else (int(size),)
        n, *sample = self._shape
        few = shape[-1] if len(shape) == len(self._shape) and shape[-1] <= MOST_TAPS else 1
        shared = {(n,), (*self._shape[:-1], few), (n, *(1 for _ in sample[1:]), few)}
        if self.events or shape not in {self._shape, self._shape[1:], *shared}:
            return self.chance.standard_normal(size)
        if not self._size:
            return np.zeros(shape)
        if self._n < 2:
            return self._size * default_rng(self._seed).standard_normal(shape)
        if shape == self._shape[1:]:
            return self._size * self._next_line()
        if shape != self._shape and np.prod(shape) == n * few:
            self._arrays += 1
            told = [designed_sequences(self._n, w + self._arrays, few) for w in self._which]
            return self._size * np.concatenate(told).reshape(shape)
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

    def _about(self, mean: Floats, variance: Floats, size: Any) -> Any:
        shape = np.broadcast_shapes(mean.shape, variance.shape)
        if self._size and self._n > 1 and size is None and shape == self._shape[:-1]:
            # Counts of one column after the other, along a register.
            return mean + self._size * np.sqrt(variance) * self._next_column()
        return super()._about(mean, variance, size)

    def _next_line(self) -> Floats:
        return self._next(self._n, lambda: self._designed(self._shape[1:]))

    def _next_column(self) -> Floats:
        sample = (*self._shape[1:-1], WIDTH)
        return self._next(WIDTH, lambda: np.moveaxis(self._designed(sample), -1, 0))

    def _next(self, length: int, more: Callable[[], Floats]) -> Floats:
        """Return the next entry of the array of this share, whose first axis has `length`."""
        k, array = self._given.get(self._share, (length, np.zeros(0)))
        if k == length:
            k, array = 0, more()
        self._given[self._share] = k + 1, array
        return np.asarray(array[k])

    def _designed(self, sample: tuple[int, ...]) -> Floats:
        more = 3 * self._arrays
        self._arrays += 1
        each = [designed_normals(self._n, sample, w + more, self._source) for w in self._which]
        return np.concatenate(each)


class Prepared(Moments):
    """Answers links of the baseline for lines of many blocks at once, with what was prepared."""

    def __init__(self, normals: Floats) -> None:
        """Answer with `normals`, (n_lines, *sample)."""
        super().__init__(_SHARED, noise=1.0)
        self._normals = normals

    def standard_normal(self, *_: Any, **__: Any) -> Any:
        """Return what was prepared."""
        return self._normals
