"""Which blocks of a recording are corrected, and which are read because pixels remember them."""

from collections.abc import Sequence

from calib.errors import InputError
from calib.radiometric.coefficients.coefficient_set import CoefficientSet
from calib.radiometric.correction.apply import Correction
from calib.radiometric.correction.apply_options import ApplyOptions
from calib.radiometric.correction.inversion import remembers
from calib.recording.header import Block
from calib.recording.protocol import Recording


def chosen_blocks(recording: Recording, names: Sequence[str] | None) -> tuple[Block, ...]:
    """Return the blocks of these names, or all but darks, in the order of acquisition."""
    blocks = recording.header.blocks
    missing = set(names or ()) - {block.block for block in blocks}
    if missing:
        there = ", ".join(block.block for block in blocks)
        msg = f"{recording.path} has no block {', '.join(sorted(missing))}: it has {there}."
        raise InputError(msg, code="no-such-block")
    if names is None:
        chosen = tuple(b for b in blocks if b.kind != "dark")
    else:
        chosen = tuple(b for b in blocks if b.block in names)
    if names is None and blocks and not chosen:
        msg = (
            f"{recording.path} has capped darks only, which have no radiance: record a scene, or "
            "name the blocks to correct."
        )
        raise InputError(msg, code="only-darks")
    if not chosen:
        msg = f"{recording.path} has no blocks to correct: record some, or resume it."
        raise InputError(msg, code="no-such-block")
    return chosen


def corrections_by_block(
    recording: Recording,
    coefficients: CoefficientSet,
    options: ApplyOptions,
    chosen: Sequence[Block],
) -> dict[str, Correction]:
    """Return the corrections of the blocks to read, by name: the chosen ones.

    Where pixels remember, also of the blocks before them, each following the one before.
    """
    corrections: dict[str, Correction] = {}
    last = None
    needed = recording.header.blocks if remembers(coefficients) else chosen
    for block in needed:
        last = options.correction(recording, block, coefficients, last)
        corrections[block.block] = last
        if block.block == chosen[-1].block:
            break
    return corrections
