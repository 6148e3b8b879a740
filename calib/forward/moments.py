"""A generator whose counts have the mean and variance of those that are drawn, but are smooth.

Links ask it for numbers as they ask any other. With `noise` 0 it answers with expectations, so that
a link's own formula gives the mean of what it does, wherever that is linear in what it draws. With
`noise` 1 counts are normal numbers: two runs that start from the same seed then differ by what was
changed between them and hardly by chance (common random numbers; Glasserman, Monte Carlo Methods in
Financial Engineering (2003), section 7.1), while drawn counts would jump.
"""

from typing import Any

import numpy as np
from numpy.random import PCG64, BitGenerator, Generator
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]


class Moments(Generator):
    """Answers `poisson`, `binomial` and `standard_normal` with mean + noise x deviation x normal.

    Whatever else is asked for is drawn as ever.
    """

    def __init__(self, seed: int | list[int] | BitGenerator, *, noise: float) -> None:
        """Start from `seed`; `noise` 0 for expectations, 1 for the true standard deviation."""
        super().__init__(seed if isinstance(seed, BitGenerator) else PCG64(seed))
        self._noise = noise

    def poisson(self, lam: ArrayLike = 1.0, size: Any = None) -> Any:
        """Return numbers of mean and variance `lam`."""
        mean = np.asarray(lam, np.float64)
        return self._about(mean, np.maximum(mean, 0.0), size)

    def binomial(self, n: ArrayLike, p: ArrayLike, size: Any = None) -> Any:
        """Return numbers of mean n p and variance n p (1 - p)."""
        share = np.asarray(p, np.float64)
        mean = np.asarray(n, np.float64) * share
        return self._about(mean, mean * (1.0 - share), size)

    def standard_normal(self, size: Any = None, *_: Any, **__: Any) -> Any:
        """Return normal numbers of standard deviation `noise`, in double precision."""
        drawn = np.asarray(super().standard_normal(size), np.float64)
        return self._noise * drawn

    def _about(self, mean: Floats, variance: Floats, size: Any) -> Any:
        if not self._noise:
            return mean if size is None else np.broadcast_to(mean, size).copy()
        shape = np.broadcast_shapes(mean.shape, variance.shape) if size is None else size
        return mean + np.sqrt(variance) * self.standard_normal(shape)
