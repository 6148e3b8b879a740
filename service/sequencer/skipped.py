"""Blocks that were left out, as the recording's own notes keep them."""

import re
from collections.abc import Iterable

_SKIPPED = re.compile(r"block (\S+) left out: ")


def skipped_note(block: str, why: str) -> str:
    """Return the note that keeps `block` from being taken when the run is resumed."""
    return f"block {block} left out: {why}"


def skipped_blocks(notes: Iterable[str]) -> tuple[str, ...]:
    """Return the blocks that `notes` leave out, each once, in their order."""
    found = (_SKIPPED.match(note) for note in notes)
    return tuple(dict.fromkeys(match[1] for match in found if match))
