"""Lines that come twice: the whole of one, or half a packet of it, one or two lines late."""

import numpy as np
from numpy.typing import NDArray

FEWEST_PIXELS = 8
"""Parts of lines of so few pixels may be alike by chance."""
MOST_PAIRS = 64
"""Of neighbouring lines, that tell how often pixels are alike by chance."""
UNLIKELY = 1e-6
"""So many repeated lines of a block may be expected by chance."""
LATEST = 2
"""A line is compared with so many before it."""


def repeated_in_blocks(samples: NDArray[np.generic]) -> NDArray[np.bool_]:
    """Return `repeated_lines` of blocks, (n_blocks, n_lines); most of them have none.

    Args:
        samples: (n_blocks, n_lines, n_rows, n_columns).
    """
    repeated = np.zeros(samples.shape[:2], bool)
    middle = samples.shape[-1] // 2
    may = np.zeros(len(samples), bool)
    for half in (samples[..., :middle], samples[..., middle:]):
        few = half.reshape(*samples.shape[:2], -1)[..., :FEWEST_PIXELS]
        for late in range(1, LATEST + 1):
            may |= (few[:, late:] == few[:, :-late]).all(axis=2).any(axis=1)
    for b in np.flatnonzero(may):
        repeated[b] = repeated_lines(samples[b])
    return repeated


def repeated_lines(samples: NDArray[np.generic]) -> NDArray[np.bool_]:
    """Return which lines, (n_lines,), repeat one shortly before, or half of it, code for code.

    None where the noise is so low that lines are alike by chance.

    Args:
        samples: (n_lines, n_rows, n_columns).
    """
    flat = samples.reshape(len(samples), -1)
    repeated = np.zeros(len(flat), bool)
    middle = samples.shape[-1] // 2
    halves = (samples[..., :middle], samples[..., middle:])
    for half in halves:
        part = np.ascontiguousarray(half.reshape(len(samples), -1))
        for late in range(1, LATEST + 1):
            repeated |= _alike(part, late)
    return repeated


def _alike(flat: NDArray[np.generic], late: int) -> NDArray[np.bool_]:
    """Return which lines of `flat`, (n_lines, n_pixels), are those `late` before."""
    repeated = np.zeros(len(flat), bool)
    if flat.shape[1] <= FEWEST_PIXELS or len(flat) <= late:
        return repeated
    # A few pixels tell most lines apart.
    few = (flat[late:, :FEWEST_PIXELS] == flat[:-late, :FEWEST_PIXELS]).all(axis=1)
    at = np.flatnonzero(few) + late
    at = at[[np.array_equal(flat[k], flat[k - late]) for k in at]] if len(at) else at
    if len(at) == 0:
        return repeated
    repeated[at] = True
    different = np.flatnonzero(~repeated[late:])[:MOST_PAIRS] + late
    same = flat[different] == flat[different - late]
    alike = same.mean(axis=0) if len(different) else np.ones(1)
    by_chance = len(flat) * np.exp(np.log(np.maximum(alike, 1.0 / MOST_PAIRS)).sum())
    return repeated if by_chance < UNLIKELY else np.zeros(len(flat), bool)
