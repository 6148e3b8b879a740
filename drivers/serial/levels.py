"""Which levels a source can be asked for."""

from math import isfinite

from drivers.errors import SettingRefusedError


def level_within(level: float, max_level: float, device: str) -> float:
    """Return `level`; SettingRefusedError (`level-out-of-range`) outside 0 ... `max_level`."""
    if not (isfinite(level) and 0.0 <= level <= max_level):
        raise SettingRefusedError(
            f"{device}: level {level:g} is outside 0 ... {max_level:g}",
            device=device,
            code="level-out-of-range",
        )
    return level


def whole_level(level: float, n_lamps: int, device: str) -> int:
    """Return how many lamps burn at `level`; a part of a lamp is refused."""
    if level_within(level, n_lamps, device) != int(level):
        raise SettingRefusedError(
            f"{device}: level {level:g} is no whole number of lamps; use 0 ... {n_lamps}",
            device=device,
            code="level-out-of-range",
        )
    return int(level)
