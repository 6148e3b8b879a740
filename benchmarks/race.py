"""Contestants on the same work: the rate of each, and how many times as fast ours is."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from benchmarks.timing import take_turns

OURS = "ours"


@dataclass(frozen=True)
class Figure:
    """What one contestant reached.

    Attributes:
        rate: Work per second, in the row's unit.
        ours_is: How many times as fast ours was in the same turns.
    """

    rate: float
    ours_is: float


def race(
    work: float, contestants: Mapping[str, Callable[[], object]], *, rounds: int
) -> dict[str, Figure]:
    """Let `contestants`, "ours" among them, do `work` (in units of the rate) in turns."""
    timing = take_turns(contestants, rounds=rounds)
    return {
        name: Figure(work / timing.seconds(name), timing.ratio(name, to=OURS))
        for name in contestants
    }
