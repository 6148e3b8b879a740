"""Cells made ready for the curve: dark level known, rounding undone, classes made, defects out."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.transfer.photon_transfer.cells import BlockCells
from calib.transfer.photon_transfer.class_average import Members, PreparedBlock, near_an_end
from calib.transfer.photon_transfer.classes import Numbers, classes, defects, relative_signal
from calib.transfer.photon_transfer.dark_level import DarkLevel, dark_level
from calib.transfer.photon_transfer.noise_line import NoiseLine, noise_line
from calib.transfer.photon_transfer.recorded_cells import RecordedCells
from calib.transfer.photon_transfer.unrounding import UnroundedCells, unrounded_cells
from calib.transfer.photon_transfer.variance_curve import rounded_variance

_MOST_CUT = 0.5


@dataclass(frozen=True)
class Prepared:
    """What points are averaged from.

    Attributes:
        blocks: Darks and flats with variances.
        dark: The dark level.
        members: The cells by class.
        defects: How many cells were left out as their variance is not that of their class.
    """

    blocks: tuple[PreparedBlock, ...]
    dark: DarkLevel
    members: Members
    defects: int


def prepare(recorded: RecordedCells, blocks: Sequence[BlockCells]) -> Prepared:
    """Make the cells of `blocks` ready.

    The noise decides how rounding is undone, and defects are told from the rest once it is: of
    little noise, variances differ from cell to cell by their phases alone. Where there are some,
    the noise is found again without them.
    """
    tap, top = recorded.tap, recorded.full_scale_dn
    dark = dark_level(blocks, tap, recorded.pixels)
    usable = np.array([~near_an_end(b, top) for b in blocks])
    bad = np.zeros(len(tap), np.bool_)
    for _ in range(2):
        line = noise_line(blocks, dark, tap, usable & ~bad)
        done = _unrounded(recorded, blocks, dark, line)
        level = dark_level(done.blocks, tap, recorded.pixels)
        number = classes(relative_signal(done.blocks, level.offset_dn, tap, top), tap)
        found = defects(done.blocks, tap, number, usable & ~done.unknown)
        if not (found & ~bad).any():
            break
        bad = found
    cut = _cut_darks(recorded, blocks, line)
    members = Members.of(
        tap,
        number,
        out=found | _exceptions(np.logical_or.reduce(cut), tap),
        pixels=recorded.pixels,
        full_scale_dn=top,
    )
    ready = map(PreparedBlock, done.blocks, done.unknown, done.lever, cut)
    return Prepared(tuple(ready), level, members, int(found.sum()))


def _unrounded(
    recorded: RecordedCells, blocks: Sequence[BlockCells], dark: DarkLevel, line: NoiseLine
) -> UnroundedCells:
    return unrounded_cells(blocks, dark, line, tap=recorded.tap, pixels=recorded.pixels)


def _cut_darks(
    recorded: RecordedCells, blocks: Sequence[BlockCells], line: NoiseLine
) -> NDArray[np.bool_]:
    """Return which darks' cells come near an end of the codes, (n_blocks, n_cells).

    Their dark level is off, and their variance too small. The noise that is expected decides: what
    is seen would let pass those whose variance happens to be small.
    """
    expected = rounded_variance(line.read_variance_dn2)[recorded.tap]
    top, nowhere = recorded.full_scale_dn, np.zeros(len(recorded.tap), np.bool_)
    return np.array(
        [near_an_end(b, top, expected) if b.block.kind == "dark" else nowhere for b in blocks]
    )


def _exceptions(cut: NDArray[np.bool_], tap: Numbers) -> NDArray[np.bool_]:
    """Return the cells that are cut where most of their tap's are not, (n_cells,).

    Where most are, the darks are left out instead.
    """
    share = np.bincount(tap, cut) / np.bincount(tap)
    return np.asarray(cut & (share < _MOST_CUT)[tap])
