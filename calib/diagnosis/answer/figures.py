"""Residuals that a report draws."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Figures:
    """What a report draws.

    Attributes:
        residual_means: Of the plain model, whitened, (n_blocks, n_pixels).
        final_means: Of the final model, likewise.
        block_names: Of the blocks.
        looks: Each way of looking at the remainder, with its distance from chance.
        gains: What each effect alone would explain, by name.
    """

    residual_means: Floats
    final_means: Floats
    block_names: tuple[str, ...]
    looks: tuple[tuple[str, float], ...]
    gains: dict[str, float] = field(default_factory=dict)
