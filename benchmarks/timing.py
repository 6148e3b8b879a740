"""Timing that can be compared: contestants take turns, and their medians are quoted.

Absolute figures wander with the machine; ratios within one run do not.
"""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from statistics import median


@dataclass(frozen=True)
class Timing:
    """Seconds per call of each contestant, by name: the median over the rounds."""

    seconds: Mapping[str, float]

    def ratio(self, name: str, to: str) -> float:
        """How many times as long `name` takes as `to`."""
        return self.seconds[name] / self.seconds[to]


def take_turns(
    contestants: Mapping[str, Callable[[], object]], *, rounds: int = 7, warm_up: int = 1
) -> Timing:
    """Call every contestant once per round, in turn, after `warm_up` rounds that do not count."""
    taken: dict[str, list[float]] = {name: [] for name in contestants}
    for round_index in range(warm_up + rounds):
        for name, call in contestants.items():
            start = time.perf_counter()
            call()
            if round_index >= warm_up:
                taken[name].append(time.perf_counter() - start)
    return Timing({name: median(times) for name, times in taken.items()})
