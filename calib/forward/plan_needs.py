"""What a plan must hold for an effect to be seen at all, as conditions on its blocks.

Each function returns None where the blocks have it, else one phrase that begins with "needs".
"""

from collections.abc import Sequence

from calib.recording.header import Block, CameraHeader


def first_lack(*lacks: str | None) -> str | None:
    """Return the first condition that is not met, None where all are."""
    return next((lack for lack in lacks if lack is not None), None)


def several_flats(blocks: Sequence[Block], n: int) -> str | None:
    """`n` flats or more."""
    return None if len(_flats(blocks)) >= n else f"needs {_count(n)} flats or more"


def several_blocks(blocks: Sequence[Block], n: int) -> str | None:
    """`n` blocks or more, of whatever kind."""
    return None if len(blocks) >= n else f"needs {_count(n)} blocks or more"


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


def any_of(*lacks: str | None) -> str | None:
    """Return None where one condition is met, else what would meet one."""
    if None in lacks:
        return None
    return ", or ".join([str(lacks[0]), *(str(lack).removeprefix("needs ") for lack in lacks[1:])])


def flats(blocks: Sequence[Block], lines: int = 1) -> str | None:
    """A flat of `lines` lines or more; a block that does not tell has enough."""
    wanted = "needs a flat" if lines == 1 else f"needs a flat of {_count(lines)} lines or more"
    return None if any((block.lines or lines) >= lines for block in _flats(blocks)) else wanted


def lines(blocks: Sequence[Block], n: int) -> str | None:
    """A block of `n` lines or more; a block that does not tell has enough."""
    enough = any((block.lines or n) >= n for block in blocks)
    return None if enough else f"needs a block of {_count(n)} lines or more"


def signals(blocks: Sequence[Block], n: int) -> str | None:
    """`n` different signals or more, exposure times level; all darks are one."""
    seen = {block.exposure_us * block.level for block in _flats(blocks)}
    n_seen = len(seen - {0.0}) + bool(_darks(blocks) or 0.0 in seen)
    return None if n_seen >= n else f"needs {_count(n)} different signals or more, a dark being one"


def repeated_flats(blocks: Sequence[Block]) -> str | None:
    """A flat that is taken again at another time."""
    return None if repeated_conditions(_flats(blocks)) is None else "needs a flat that is repeated"


def offset_known(blocks: Sequence[Block]) -> str | None:
    """The offset apart from the light: from a dark, or from where flats of two exposures meet."""
    return any_of(darks(blocks), flats_at_exposures(blocks, 2))


def light_against_level(blocks: Sequence[Block]) -> str | None:
    """Enough to see that light is not in proportion to the level."""
    bends = any_of(offset_known(blocks), flats_at_levels(blocks, 3))
    return first_lack(flats_at_levels(blocks, 2), bends)


def dark_growth(blocks: Sequence[Block]) -> str | None:
    """Enough to see that a signal without light grows with exposure.

    Flats show it, too, where their signal at no exposure is not that at no light.
    """
    of_flats = first_lack(
        flats_at_exposures(blocks, 2), any_of(darks(blocks), flats_at_levels(blocks, 2))
    )
    if None in {darks_at_exposures(blocks, 2), of_flats}:
        return None
    return "needs darks at two exposures or more, or such flats with a dark or at two levels"


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
    return {1: "one", 2: "two", 3: "three", 4: "four", 5: "five", 8: "eight"}.get(n, str(n))
