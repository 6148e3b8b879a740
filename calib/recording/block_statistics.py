"""What one pass over a block leaves behind, column by column."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.arrays import Columns
from calib.recording.header import Block


@dataclass(frozen=True)
class BlockStatistics:
    """Exact temporal statistics of a block, each (n_columns,); an area sensor's pixels flattened.

    Attributes:
        block: The conditions.
        n_lines: How many lines (frames of an area sensor) they are from.
        mean_dn: Mean code.
        variance_dn2: Unbiased temporal variance; NaN where n_lines is 1.
        n_at_zero: How many samples stood at code 0.
        n_at_full_scale: How many samples stood at the highest code.
    """

    block: Block
    n_lines: int
    mean_dn: Columns
    variance_dn2: Columns
    n_at_zero: NDArray[np.int64]
    n_at_full_scale: NDArray[np.int64]


@dataclass(frozen=True)
class RecordingStatistics:
    """A recording's blocks in the order of acquisition, split by lines.

    `fit` is what estimates are made from, `held_out` what they are judged on; a line is in one
    of the two. `held_out` is empty where nothing was asked to be held out.
    """

    fit: tuple[BlockStatistics, ...]
    held_out: tuple[BlockStatistics, ...] = ()
