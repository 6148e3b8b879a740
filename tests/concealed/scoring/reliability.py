"""Whether stated probabilities are kept: the reliability curve and its expected error.

Source: Guo et al., On Calibration of Modern Neural Networks, ICML 2017, equations 2 and 3.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from tests.concealed.scoring.intervals import Share
from tests.concealed.scoring.outcome import Outcome

N_BINS = 10


@dataclass(frozen=True)
class Bin:
    """Findings whose stated probabilities are alike: their mean, and how many were right."""

    stated: float
    right: Share

    @property
    def kept(self) -> bool:
        """Whether the mean stated probability lies in the interval of the share."""
        return self.right.low <= self.stated <= self.right.high


def statements(outcomes: Iterable[Outcome]) -> list[tuple[float, bool]]:
    """Return the probability of each candidate that was put forward, and whether it is hidden."""
    return [
        (probability, name in one.hidden_names)
        for one in outcomes
        for finding in one.findings
        for name, probability in finding.candidates or ((finding.name, finding.probability),)
    ]


def reliability_curve(stated: Sequence[tuple[float, bool]]) -> list[Bin]:
    """Return the bins, of equal width, that are not empty."""
    place = [min(int(probability * N_BINS), N_BINS - 1) for probability, _ in stated]
    bins = []
    for k in range(N_BINS):
        inside = [one for one, at in zip(stated, place, strict=True) if at == k]
        if inside:
            mean = float(np.mean([probability for probability, _ in inside]))
            bins.append(Bin(mean, Share.of(right for _, right in inside)))
    return bins


def expected_calibration_error(curve: Sequence[Bin]) -> float:
    """Return the mean distance of stated and kept, weighted by numbers; NaN of none."""
    total = sum(one.right.n for one in curve)
    if not total:
        return float("nan")
    return sum(one.right.n * abs(one.stated - one.right.value) for one in curve) / total
