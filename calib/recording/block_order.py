"""Blocks are told apart by name and stand in the order in which they were acquired."""

import re
from collections.abc import Sequence

from calib.errors import InputError
from calib.recording.header import Block

# A block's name is also the name of its file of frames.
_NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.+-]*")


def check_new_block(earlier: Sequence[Block], block: Block, where: str) -> None:
    """Raise InputError where `block` has a bad name, one given before, or starts too early."""
    if not _NAME.fullmatch(block.block):
        raise InputError(
            f"{where}: block {block.block!r} needs a name of letters, digits, '_', '-', '+', '.'",
            code="block-name-invalid",
        )
    if any(block.block == other.block for other in earlier):
        raise InputError(
            f"{where}: block {block.block} is there twice: give each block a name of its own",
            code="duplicate-block",
        )
    check_order(earlier, block, where)


def check_order(earlier: Sequence[Block], block: Block, where: str) -> None:
    """Raise InputError where `block` started before one of `earlier`; unknown times pass."""
    known = [other for other in earlier if other.started_s is not None]
    if block.started_s is None or not known:
        return
    last = max(known, key=lambda other: other.started_s or 0.0)
    if last.started_s is not None and block.started_s < last.started_s:
        raise InputError(
            f"{where}: block {block.block} started at {block.started_s} s, before block "
            f"{last.block} at {last.started_s} s that stands above it: put the blocks in the "
            "order in which they were acquired, or leave started_s empty",
            code="conditions-out-of-order",
        )
