"""What a recording must hold to be diagnosed at all."""

from calib.errors import NotDeterminedError
from calib.recording.header import RecordingHeader

FEWEST_LINES = 4


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
    if known and max(known) < FEWEST_LINES:
        raise NotDeterminedError(
            f"no block has more than {max(known)} lines: record blocks of {FEWEST_LINES} lines or "
            "more, best 100, to tell noise",
            code="too-few-lines",
        )
