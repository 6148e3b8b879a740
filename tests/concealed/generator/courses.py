"""Courses in time that a drift takes: 0 at the recording's start, of size about 1."""

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

Times = NDArray[np.float64]
"""Shares of the recording's duration, 0 … 1."""

KNOWN = ("exponential", "linear")
FOREIGN = ("step", "sinusoid", "return")


def course(shape: str, constant: float, share: Times) -> Times:
    """Return the course at `share` of the duration.

    Args:
        shape: One of KNOWN or FOREIGN.
        constant: Time constant, place of the step, or period; a share of the duration.
        share: Any shape.

    >>> [float(course("step", 0.5, np.array(s))) for s in (0.0, 0.6)]
    [0.0, 1.0]
    """
    if shape == "exponential":
        return np.asarray(-np.expm1(-share / constant) / -np.expm1(-1.0 / constant))
    if shape == "linear":
        return np.asarray(share)
    if shape == "step":
        return np.asarray((share > constant).astype(float))
    if shape == "sinusoid":
        return np.asarray(np.sin(2 * np.pi * share / constant))
    return np.asarray(np.clip(1.0 - np.abs(share / constant - 1.0), 0.0, None))


def draw_constant(rng: Generator) -> float:
    """Return a constant at which each course differs from a constant factor."""
    return float(rng.uniform(0.3, 0.7))
