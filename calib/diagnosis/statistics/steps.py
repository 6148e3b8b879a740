"""Steps within blocks: from some line, or frame, on all pixels stand higher or lower.

Block means do not show them, and noise that a line's pixels share takes them in. The split of a
block's line means into two stretches is judged by Student's t about the scatter within both, for
shared noise is in that scatter, each split of each block counted as a look (Bonferroni).
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.stats import t as student

from calib.diagnosis.recorded.sensor import Sensor
from calib.diagnosis.statistics.block_sums import BlockSums
from calib.diagnosis.statistics.whole_lines import whole_lines

Floats = NDArray[np.float64]

SHORTEST = 3
"""A stretch has so many lines, or more: two of them may be alike by chance."""
UNLIKELY = 0.01
"""A step is told where chance makes one so seldom in a recording."""


def steps(sums: Sequence[BlockSums], names: Sequence[str], sensor: Sensor) -> tuple[str, ...]:
    """Return a sentence for each block whose lines step."""
    means = [whole_lines(each, sensor) for each in sums]
    looks = sum(max(len(m) - 2 * SHORTEST + 1, 0) for m in means)
    told = []
    for name, line_means in zip(names, means, strict=True):
        if len(line_means) < 2 * SHORTEST + 2:
            continue
        first, height, std, p = highest_step(line_means)
        if p * looks < UNLIKELY:
            told.append(
                f"In block {name} all pixels step by {height:+.3g} +- {std:.2g} DN after the first "
                f"{first} of {len(line_means)} lines or frames, which chance does with a "
                f"probability of {max(p * looks, 1e-16):.1g}; its mean and its shared noise hold "
                "that step."
            )
    return tuple(told)


def highest_step(values: Floats) -> tuple[int, float, float, float]:
    """Return where the clearest step lies, its height, standard error, and chance of a split."""
    n = len(values)
    before = np.arange(SHORTEST, n - SHORTEST + 1)
    sums, squares = np.cumsum(values - values.mean()), float(((values - values.mean()) ** 2).sum())
    below = sums[before - 1]
    height = -below / before - below / (n - before)
    between = below**2 * (1.0 / before + 1.0 / (n - before))
    within = np.maximum(squares - between, 1e-300) / (n - 2)
    std = np.sqrt(within * (1.0 / before + 1.0 / (n - before)))
    k = int(np.argmax(np.abs(height) / std))
    chance = float(2.0 * student.sf(abs(height[k]) / std[k], n - 2))
    return int(before[k]), float(height[k]), float(std[k]), chance
