"""Mean signals of a tap's flats, as they follow the exposure."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.arrays import Columns
from calib.transfer.photon_transfer.points import Points


@dataclass(frozen=True)
class Means:
    """One mean per block, over all classes of a tap; arrays (n_blocks,).

    Attributes:
        block: Number of the block, as in `Points`.
        exposure_us: Of the block.
        group: Number of the level; those of one level have one radiance.
        levels: In ascending order, (n_groups,).
        signal_dn: Above the dark level.
        spread: Relative variance of the signal over the tap's pixels.
        samples: How many codes the mean is from.
    """

    block: NDArray[np.intp]
    exposure_us: Columns
    group: NDArray[np.intp]
    levels: Columns
    signal_dn: Columns
    spread: Columns
    samples: Columns

    def __len__(self) -> int:
        return len(self.signal_dn)

    @property
    def n_groups(self) -> int:
        """How many levels."""
        return len(self.levels)

    @property
    def freedom(self) -> int:
        """How many means are left once levels, exposure offset and one bend are fitted."""
        return len(self) - self.n_groups - 2


def means_of(points: Points) -> Means | None:
    """Return the means of the flats in `points`; None where they tell nothing of the response.

    A level counts that was recorded at two exposures or more, and a block all of whose classes are
    in `points`. The response's bend, the levels and an offset of the exposure are fitted to them:
    one mean more than these has to be left.
    """
    flats = points.where(~points.is_dark)
    if not len(flats) or not np.isfinite(flats.signal_dn).all():
        return None
    per_block = np.bincount(flats.block)
    whole = per_block[flats.block] == per_block.max()
    rows = [flats.where((flats.block == b) & whole) for b in np.unique(flats.block[whole])]
    rows = [r for r in rows if _is_shared(r, rows)]
    if not rows:
        return None
    levels, group = np.unique([r.level[0] for r in rows], return_inverse=True)
    found = Means(
        block=np.array([r.block[0] for r in rows]),
        exposure_us=np.array([r.exposure_us[0] for r in rows]),
        group=group,
        levels=levels,
        signal_dn=np.array([np.average(r.signal_dn, weights=r.pixels) for r in rows]),
        spread=np.array([_spread(r) for r in rows]),
        samples=np.array([r.samples.sum() for r in rows]),
    )
    return found if found.freedom >= 1 and (found.signal_dn > 0).all() else None


def _is_shared(row: Points, rows: list[Points]) -> bool:
    """Return whether the block's level was recorded at another exposure, too."""
    same = [r for r in rows if r.level[0] == row.level[0]]
    return len({float(r.exposure_us[0]) for r in same}) > 1


def _spread(row: Points) -> float:
    mean = float(np.average(row.signal_dn, weights=row.pixels))
    square = np.average((1.0 + row.spread) * row.signal_dn**2, weights=row.pixels)
    return float(square / mean**2 - 1.0)
