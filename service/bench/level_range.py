"""Whether a bench has the light that a plan asks for."""

from collections.abc import Iterable

from calib.errors import InputError


def check_levels(levels: Iterable[float], max_level: float, bench_id: str) -> None:
    """Raise InputError `level-out-of-range` where the light does not go to the highest level."""
    highest = max(levels)
    if highest > max_level:
        msg = (
            f"the plan asks for level {highest:g}, but the light of bench {bench_id!r} goes to"
            f" {max_level:g}; lower the level, or take another bench"
        )
        raise InputError(msg, code="level-out-of-range")
