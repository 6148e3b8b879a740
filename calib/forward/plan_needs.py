"""What a plan must hold for an effect to be seen at all, as conditions on its blocks.

Each function returns None where the blocks have it, else one phrase that begins with "needs".
"""

from collections.abc import Sequence

from calib.recording.header import Block, CameraHeader


def first_lack(*lacks: str | None) -> str | None:
    """Return the first condition that is not met, None where all are."""
    return next((lack for lack in lacks if lack is not None), None)


def flats(blocks: Sequence[Block], n: int) -> str | None:
    """`n` flats or more."""
    if len(_flats(blocks)) >= n:
        return None
    return "needs a flat" if n == 1 else f"needs {_count(n)} flats or more"


def several_blocks(blocks: Sequence[Block], n: int) -> str | None:
    """`n` blocks or more, of whatever kind."""
    return None if len(blocks) >= n else f"needs {_count(n)} blocks or more"


def lines(blocks: Sequence[Block], n: int) -> str | None:
    """A block of `n` lines, or frames, or more; one whose length is not yet known may have them."""
    enough = any(block.lines is None or block.lines >= n for block in blocks)
    return None if enough else f"needs a block of {_count(n)} lines or more"


def lit_lines(blocks: Sequence[Block], n: int) -> str | None:
    """A flat of `n` lines, or frames, or more."""
    return first_lack(flats(blocks, 1), lines(_flats(blocks), n))


def neighbours(camera: CameraHeader) -> str | None:
    """Pixels that have a neighbour in their row."""
    return None if camera.columns > 1 else "needs two columns or more"


def taps(camera: CameraHeader) -> str | None:
    """More than one tap."""
    return None if camera.taps > 1 else "needs a camera of two taps or more"


def darker_after_brighter(blocks: Sequence[Block]) -> str | None:
    """A block that is darker than one before it; blocks in the order of time."""
    light = [b.level * b.exposure_us * (b.kind != "dark") for b in blocks]
    falls = any(later < max(light[:k]) for k, later in enumerate(light) if k > 0)
    return None if falls else "needs a darker block after a brighter one"


def flats_at_levels(blocks: Sequence[Block], n: int) -> str | None:
    """Flats at `n` levels of light or more."""
    levels = {block.level for block in _flats(blocks)}
    return None if len(levels) >= n else f"needs flats at {_count(n)} levels or more"


def flats_at_exposures(blocks: Sequence[Block], n: int) -> str | None:
    """Flats at `n` exposure times or more."""
    exposures = {block.exposure_us for block in _flats(blocks)}
    return None if len(exposures) >= n else f"needs flats at {_count(n)} exposures or more"


def darks(blocks: Sequence[Block]) -> str | None:
    """A capped dark."""
    return None if _darks(blocks) else "needs a dark"


def darks_at_exposures(blocks: Sequence[Block], n: int) -> str | None:
    """Darks at `n` exposure times or more."""
    exposures = {block.exposure_us for block in _darks(blocks)}
    return None if len(exposures) >= n else f"needs darks at {_count(n)} exposures or more"


def repeated_conditions(blocks: Sequence[Block]) -> str | None:
    """The same exposure and level twice or more, at different times."""
    seen = [(block.kind, block.exposure_us, block.level) for block in blocks]
    return None if len(set(seen)) < len(seen) else "needs a block that is taken twice"


def temperatures(blocks: Sequence[Block], spread_c: float) -> str | None:
    """Sensor temperatures that differ by `spread_c` or more."""
    known = [b.sensor_temperature_c for b in blocks if b.sensor_temperature_c is not None]
    wide = bool(known) and max(known) - min(known) >= spread_c
    return None if wide else f"needs sensor temperatures {spread_c:g} K apart or more"


def _flats(blocks: Sequence[Block]) -> list[Block]:
    return [block for block in blocks if block.kind == "flat"]


def _darks(blocks: Sequence[Block]) -> list[Block]:
    return [block for block in blocks if block.kind == "dark"]


def _count(n: int) -> str:
    return {1: "one", 2: "two", 3: "three", 4: "four", 5: "five"}.get(n, str(n))
