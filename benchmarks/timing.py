"""Timing that can be compared: contestants take turns, and ratios are taken turn by turn.

Absolute figures wander with the machine; ratios within one run do not.
"""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from statistics import median


class OwnTime(float):
    """Seconds that a contestant took by its own clock."""


@dataclass(frozen=True)
class Timing:
    """Seconds per call of each contestant, by name, one for each round."""

    rounds: Mapping[str, tuple[float, ...]]

    def seconds(self, name: str) -> float:
        """Return the median over the rounds."""
        return median(self.rounds[name])

    def ratio(self, name: str, to: str) -> float:
        """Return how many times as long `name` takes as `to`: the median of the rounds' ratios."""
        pairs = zip(self.rounds[name], self.rounds[to], strict=True)
        return median(one / other for one, other in pairs)


def take_turns(
    contestants: Mapping[str, Callable[[], object]], *, rounds: int = 7, warm_up: int = 1
) -> Timing:
    """Call every contestant once per round, in turn, after `warm_up` rounds that do not count.

    What a contestant returns is dropped, unless it is its `OwnTime`.
    """
    taken: dict[str, list[float]] = {name: [] for name in contestants}
    for round_index in range(warm_up + rounds):
        for name, call in contestants.items():
            start = time.perf_counter()
            timed = call()
            seconds = time.perf_counter() - start
            if round_index >= warm_up:
                taken[name].append(timed if isinstance(timed, OwnTime) else seconds)
    return Timing({name: tuple(times) for name, times in taken.items()})
