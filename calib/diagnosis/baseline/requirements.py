"""What a recording must hold to be diagnosed at all."""

from collections.abc import Sequence

from calib.diagnosis.recorded.conditions_table import ConditionsTable
from calib.diagnosis.statistics.block_sums import BlockSums
from calib.errors import NotDeterminedError
from calib.recording.header import CameraHeader, RecordingHeader

FEWEST_LINES = 4
MOST_CLIPPED = 0.5
"""A block with a larger share of its samples at full scale tells no signal."""
FEWEST_FRAMES = 2
"""Of an area sensor, whose rows are lines enough."""


def check_can_be_diagnosed(header: RecordingHeader) -> None:
    """Raise NotDeterminedError, saying which blocks to add, where nothing can be told."""
    flats = [block for block in header.blocks if block.kind == "flat"]
    if not flats:
        raise NotDeterminedError(
            "the recording has no flats: add flats at two exposures or more, and a dark at each",
            code="no-flats",
        )
    doses = {(b.radiance or b.level) * b.exposure_us for b in flats}
    dark = any(block.kind == "dark" for block in header.blocks)
    if len(doses) + dark < 2:
        raise NotDeterminedError(
            "all blocks have one exposure and level, and there is no dark: add flats at another "
            "exposure, and capped darks",
            code="one-signal",
        )
    known = [block.lines for block in header.blocks if block.lines is not None]
    if known:
        _check_lines(max(known), header.camera)


def check_determined(sums: Sequence[BlockSums], table: ConditionsTable) -> None:
    """Raise NotDeterminedError, saying which blocks to add, where what was recorded tells nothing.

    Args:
        sums: Of the blocks.
        table: Their conditions.
    """
    _check_lines(max(each.n_lines for each in sums), table.camera)
    top = [each.histogram[-1] / max(each.histogram.sum(), 1) for each in sums]
    clipped = [share > MOST_CLIPPED for share in top]
    seen = {dose for dose, lost in zip(table.dose, clipped, strict=True) if not lost}
    if len(seen) < 2 and any(clipped):
        lit = zip(table.blocks, clipped, strict=True)
        shortest = min(block.exposure_us for block, lost in lit if lost)
        raise NotDeterminedError(
            f"{sum(clipped)} of {len(clipped)} blocks are saturated, and the others are of one "
            f"signal: add flats at two exposures below {shortest:g} us, or at a lower level",
            code="saturated",
        )


def _check_lines(most: int, camera: CameraHeader) -> None:
    lines = camera.rows is None
    fewest, what, best = (FEWEST_LINES, "lines", 100) if lines else (FEWEST_FRAMES, "frames", 16)
    if most < fewest:
        raise NotDeterminedError(
            f"no block has more than {most} {what}: record blocks of {fewest} {what} or more, "
            f"best {best}, to tell noise",
            code="too-few-lines",
        )
