"""Do the lamps burn that should?"""

from collections.abc import Iterator

from drivers.errors import DeviceError
from drivers.ports import LampState, LightSource, LightState

_LEVEL_TOLERANCE = 0.005
"""Of the highest level: an LED's setting is rounded to its step."""
_CURRENT_TOLERANCE = 0.01
"""Of a lamp's current; by less a supply's own regulation may move it."""


def check_burning(
    light: LightSource,
    now: LightState,
    *,
    wanted: float,
    when_set: LightState | None,
    block: str,
) -> None:
    """Raise DeviceError, code `lamp-out`, when another level burns than is wanted.

    Args:
        light: The source, for its name and range.
        now: What was read back.
        wanted: The level that should burn.
        when_set: What was read back when that level was set; names the lamps that changed.
        block: For which block.
    """
    if abs(now.level - wanted) <= _LEVEL_TOLERANCE * light.max_level:
        return
    changed = "; ".join(_changes(now, when_set)) or "no lamp says why"
    raise DeviceError(
        f"level {wanted:g} should burn in block {block}, but level {now.level:g} reads back"
        f" ({changed}); look at the lamp and its supply, then resume",
        device=light.identity.address or "light",
        code="lamp-out",
    )


def _changes(now: LightState, when_set: LightState | None) -> Iterator[str]:
    """Say of each lamp what is not as it was when it was set."""
    if when_set is None or len(when_set.lamps) != len(now.lamps):
        return
    for number, (lamp, then) in enumerate(zip(now.lamps, when_set.lamps, strict=True), start=1):
        if lamp.on != then.on:
            yield f"lamp {number} is {'on' if lamp.on else 'off'}"
        elif _differs(lamp, then):
            yield f"lamp {number} is at {lamp.current_a:.3g} A, not {then.current_a:.3g} A"


def _differs(lamp: LampState, then: LampState) -> bool:
    return abs(lamp.current_a - then.current_a) > _CURRENT_TOLERANCE * abs(then.current_a)
