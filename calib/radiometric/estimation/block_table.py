"""Blocks of one kind as arrays, so that columns are worked on together."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.arrays import Columns
from calib.recording.block_statistics import BlockStatistics
from calib.recording.header import Block, BlockKind

Cells = NDArray[np.float64]
"""A number by block and column, (n_blocks, n_columns)."""
Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class BlockTable:
    """Statistics of the blocks of one kind, in the order of acquisition.

    Attributes:
        blocks: Their conditions.
        exposure_us: (n_blocks,).
        light_us: Exposure to the level's mean light, (n_blocks,): another than `exposure_us` where
            a monitor says that the source wandered (`calib.radiometric.estimation.monitor`).
        n_lines: (n_blocks,).
        mean_dn: Mean codes, (n_blocks, n_columns).
        variance_dn2: Temporal variances, NaN where a block has one line.
        clipped: True where a sample stood at either end of the code range.
    """

    blocks: tuple[Block, ...]
    exposure_us: Columns
    light_us: Columns
    n_lines: Columns
    mean_dn: Cells
    variance_dn2: Cells
    clipped: Mask

    @classmethod
    def of_kind(cls, statistics: Sequence[BlockStatistics], kind: BlockKind) -> "BlockTable":
        """Stack the blocks of `kind`; a table may have no blocks."""
        chosen = [s for s in statistics if s.block.kind == kind and s.n_lines > 0]
        n_columns = statistics[0].mean_dn.size if statistics else 0

        def stack(rows: list[NDArray[np.float64]]) -> Cells:
            return np.array(rows, np.float64).reshape(len(chosen), n_columns)

        exposure_us = np.array([s.block.exposure_us for s in chosen], np.float64)
        clipped = [(s.n_at_zero > 0) | (s.n_at_full_scale > 0) for s in chosen]
        return cls(
            blocks=tuple(s.block for s in chosen),
            exposure_us=exposure_us,
            light_us=exposure_us,
            n_lines=np.array([s.n_lines for s in chosen], np.float64),
            mean_dn=stack([s.mean_dn for s in chosen]),
            variance_dn2=stack([s.variance_dn2 for s in chosen]),
            clipped=np.array(clipped, np.bool_).reshape(len(chosen), n_columns),
        )

    def followed_by(self, other: "BlockTable") -> "BlockTable":
        """Return the blocks of both."""
        return BlockTable(
            self.blocks + other.blocks,
            *(
                np.concatenate([getattr(self, name), getattr(other, name)])
                for name in (
                    "exposure_us",
                    "light_us",
                    "n_lines",
                    "mean_dn",
                    "variance_dn2",
                    "clipped",
                )
            ),
        )

    def __len__(self) -> int:
        return len(self.blocks)
