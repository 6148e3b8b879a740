"""How many investigations were settled, and by what."""

from collections import Counter
from dataclasses import dataclass, field
from statistics import median

from service.investigation.investigate import Investigation


@dataclass
class Tally:
    """What runs of a case came to.

    Attributes:
        runs, settled: That count since their first sweep left a name open, and of them.
        by_first, unseen: That do not count: settled by the first sweep, nothing found by it.
        asked_for: The added sweeps.
        expected_sigma: Of them.
    """

    runs: int = 0
    settled: int = 0
    by_first: int = 0
    unseen: int = 0
    asked_for: Counter[str] = field(default_factory=Counter)
    expected_sigma: list[float] = field(default_factory=list)

    def count(self, done: Investigation, *, settled: bool, was_open: bool) -> None:
        if not was_open:
            self.by_first += settled
            self.unseen += not done.examined.diagnosis.findings
            return
        self.runs += 1
        self.settled += settled
        following = done.rounds[0].diagnosis.next_measurement
        if following is not None and following.expected_sigma is not None:
            self.asked_for[following.why.split(": ")[-1]] += 1
            self.expected_sigma.append(following.expected_sigma)

    def row(self, name: str) -> str:
        sigma = f"{median(self.expected_sigma):.1f} σ" if self.expected_sigma else "-"
        asked = ", ".join(f"{what} ({n})" for what, n in self.asked_for.most_common())
        return (
            f"| {name} | {self.settled} of {self.runs} | {asked} | {sigma}"
            f" | {self.by_first} | {self.unseen} |"
        )
