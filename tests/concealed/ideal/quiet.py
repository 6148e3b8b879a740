"""A generator without chance: every draw is its expectation."""

from typing import Any, cast

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

Floats = NDArray[np.float64]


class Quiet:
    """Stands in for NumPy's generator where expected signals are wanted."""

    def poisson(self, mean: Any, size: Any = None) -> Floats:
        """Return the mean."""
        return np.array(mean if size is None else np.broadcast_to(mean, size), dtype=float)

    def binomial(self, n: Any, p: Any) -> Floats:
        """Return n p."""
        return np.asarray(np.asarray(n, dtype=float) * p)

    def standard_normal(self, size: Any = None) -> Floats:
        """Return 0."""
        return np.zeros(() if size is None else size)

    def choice(self, among: Any, size: Any) -> Floats:
        """Return the mean of what is chosen from."""
        return np.full(size, np.mean(among))

    def random(self, size: Any = None) -> Floats:
        """Return what no small chance exceeds."""
        return np.full(() if size is None else size, 0.999)


def quiet() -> Generator:
    """Return it as what mechanisms take."""
    return cast("Generator", Quiet())
