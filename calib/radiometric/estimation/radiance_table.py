"""Which radiance belongs to which level of the source."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.arrays import Columns
from calib.errors import InputError
from calib.recording.header import Block


@dataclass(frozen=True)
class LevelGroups:
    """Flat blocks sorted by what the source was set to.

    Attributes:
        of_block: Index of each block's group, (n_blocks,).
        level: Each group's level, (n_groups,).
        radiance: Each group's radiance by certificate; NaN where not known.
    """

    of_block: NDArray[np.intp]
    level: Columns
    radiance: Columns

    @property
    def known(self) -> NDArray[np.bool_]:
        """Groups whose radiance is known, (n_groups,)."""
        return np.isfinite(self.radiance)


def group_levels(
    blocks: Sequence[Block], radiances: Mapping[float, float] | None = None
) -> LevelGroups:
    """Put blocks of one level and one radiance together.

    A block whose radiance is unknown takes the one that other blocks state for its level.

    Args:
        blocks: Flat blocks.
        radiances: Radiance by level, in the recording's unit; goes before what blocks state.

    Raises:
        InputError: `bad-radiance` where a radiance is not a positive number.
    """
    for level, radiance in (radiances or {}).items():
        if not (math.isfinite(radiance) and radiance > 0):
            message = f"The radiance of level {level:g} is {radiance}: give a positive number."
            raise InputError(message, code="bad-radiance")
    for block in blocks:
        if block.radiance is not None and block.radiance <= 0:
            message = (
                f"Block {block.block} is a flat of radiance {block.radiance:g}: "
                "leave it empty where it is unknown, or call the block dark."
            )
            raise InputError(message, code="bad-radiance")
    keys = [(block.level, _radiance_of(block, blocks, radiances)) for block in blocks]
    groups = sorted(set(keys), key=lambda key: (key[0], key[1] or 0.0))
    return LevelGroups(
        of_block=np.array([groups.index(key) for key in keys], np.intp),
        level=np.array([level for level, _ in groups], np.float64),
        radiance=np.array([math.nan if r is None else r for _, r in groups], np.float64),
    )


def _radiance_of(
    block: Block, blocks: Sequence[Block], radiances: Mapping[float, float] | None
) -> float | None:
    """Return the block's radiance: by table, by itself, or by its level's only other one."""
    if radiances is not None and block.level in radiances:
        return radiances[block.level]
    if block.radiance is not None:
        return block.radiance
    stated = {b.radiance for b in blocks if b.level == block.level and b.radiance is not None}
    return stated.pop() if len(stated) == 1 else None
