"""A recording's name by its content: the same for a file and its exported folder."""

import hashlib
import json

from calib.recording.protocol import Recording

# Says only how headerless frames are stored.
_NOT_CONTENT = {"dtype"}


def digest_of(recording: Recording) -> str:
    """Return SHA-256 (hex) over the canonical header and, block by block, the codes.

    The header is JSON with sorted keys, unknown keys included, unknown values left out; the codes
    are uint8 or little-endian uint16 in C order, with the number of lines behind each block.
    """
    sha = hashlib.sha256(_canonical_header(recording))
    for block in recording.header.blocks:
        n_lines = 0
        for dn in recording.frames(block.block):
            sha.update(dn.data)
            n_lines += len(dn)
        sha.update(f"\n{block.block} {n_lines}\n".encode())
    return sha.hexdigest()


def _canonical_header(recording: Recording) -> bytes:
    content = recording.header.model_dump(
        mode="json", exclude={"camera": _NOT_CONTENT}, exclude_none=True
    )
    return json.dumps(content, sort_keys=True, separators=(",", ":")).encode()
