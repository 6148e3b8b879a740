"""What one stretch of lines leaves in the pixels for the next."""

from collections.abc import Mapping
from dataclasses import dataclass

from calib.arrays import Pixels


@dataclass(frozen=True)
class Left:
    """The state of each effect with memory when a stretch of lines had ended.

    One array per such effect, however long the sensor has been in use: charge that stays behind is
    a sum, and a trap's filling forgets as it decays.

    Attributes:
        at_s: Wall time at which the stretch ended: its last line's start and one line period.
        states: By the effect's name, (*sample,): electrons, or what the effect says.
        drawn: True where these are what a draw left; False for their expectation.
    """

    at_s: float
    states: Mapping[str, Pixels]
    drawn: bool


def both(one: Left | None, other: Left | None) -> Left | None:
    """Return what two parts of a chain left together, None where neither did."""
    if one is None or other is None:
        return one or other
    return Left(
        max(one.at_s, other.at_s), {**one.states, **other.states}, one.drawn and other.drawn
    )
