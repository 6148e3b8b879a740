"""Standard uncertainties by first-order propagation, for figures that share their inputs."""

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

Batch = NDArray[np.float64]
"""Leading axis: variants of the inputs; what follows is one variant's."""

_STEP = 0.01
"""In standard uncertainties: small against curvature, large against rounding."""


def propagate(
    figures: Callable[[Batch], Mapping[str, Batch]],
    values: NDArray[np.float64],
    stds: NDArray[np.float64],
) -> dict[str, tuple[float, float]]:
    """Return each figure's value and standard uncertainty.

    u² = Σ (∂f/∂x_i)² u_i² over independent inputs (GUM, Eq. 10), by central differences. What two
    figures share, a dark or the system gain, is moved in both at once, so that no covariance has
    to be written down.

    Args:
        figures: Takes (n_variants, n_inputs), answers (n_variants,) by name.
        values: The inputs, (n_inputs,).
        stds: Their standard uncertainties, (n_inputs,); 0 for what is exact.
    """
    moved = np.flatnonzero(stds > 0)
    steps = _STEP * stds[moved]
    batch = np.tile(values, (1 + 2 * len(moved), 1))
    up = 1 + np.arange(len(moved))
    batch[up, moved] += steps
    batch[up + len(moved), moved] -= steps
    with np.errstate(invalid="ignore", divide="ignore"):
        answers = figures(batch)
        return {name: _moments(found, len(moved)) for name, found in answers.items()}


def _moments(found: Batch, n: int) -> tuple[float, float]:
    slopes = (found[1 : n + 1] - found[n + 1 :]) / (2.0 * _STEP)
    return float(found[0]), float(np.sqrt(np.sum(slopes**2)))
