"""How often the diagnosis is right, by what was hidden and how strongly."""

import math
from collections.abc import Callable, Iterable, Sequence
from itertools import pairwise

import numpy as np
from scipy.optimize import minimize
from scipy.stats import norm

from tests.concealed.scoring.intervals import Share
from tests.concealed.scoring.outcome import Outcome

CLEARLY_SEEN = 7.0
"""Standard deviations of the ideal filter from which on a name is asked for."""
APART = 5.0
"""Standard deviations from the nearest other name from which on the right one is asked for."""
REMAINDER = 25.0
"""The same for physics that has none."""
SIGMA_BINS = (0.0, 1.0, 2.0, 3.0, 5.0, 7.0, 10.0, 15.0, 25.0, 50.0, 100.0, math.inf)
MOST_CANDIDATES = 3
_LOOKS = 33


def of_kind(outcomes: Iterable[Outcome], *kinds: str) -> list[Outcome]:
    """Return the cases of these kinds."""
    return [one for one in outcomes if one.kind in kinds]


def clearly(outcomes: Iterable[Outcome], at_least: float = CLEARLY_SEEN) -> list[Outcome]:
    """Return the cases of which the ideal filter sees every hidden effect clearly."""
    return [one for one in outcomes if one.truths and all(t.sigma >= at_least for t in one.truths)]


def told_apart(outcomes: Iterable[Outcome]) -> list[Outcome]:
    """Return those clearly seen in which no other name could make the same signature."""
    return [one for one in clearly(outcomes) if all(t.apart > APART for t in one.truths)]


def named_first(one: Outcome) -> bool:
    """Whether the strongest finding is called by a hidden effect's name."""
    return one.first in one.hidden_names


def covered(one: Outcome) -> bool:
    """Whether the strongest finding's few candidates hold a hidden effect."""
    if not one.findings:
        return False
    candidates = one.findings[0].names
    return bool(candidates & one.hidden_names) and len(candidates) <= MOST_CANDIDATES


def complete(one: Outcome) -> bool:
    """Whether all that is hidden is named."""
    return one.hidden_names <= {finding.name for finding in one.findings}


def wrongly_named(one: Outcome) -> bool:
    """Whether a finding's candidates hold nothing that is hidden."""
    return any(not finding.names & one.hidden_names for finding in one.findings)


def false_alarm(one: Outcome) -> bool:
    """Whether something was seen where nothing is hidden."""
    return one.verdict != "consistent"


def by_sigma(
    outcomes: Sequence[Outcome],
    test: Callable[[Outcome], bool] = named_first,
    bins: Sequence[float] = SIGMA_BINS,
) -> list[tuple[float, Share]]:
    """Return, per bin of the ideal filter's sight, its geometric middle and the share."""
    rows = []
    for low, high in pairwise(bins):
        inside = [one for one in outcomes if low <= one.truths[0].sigma < high]
        middle = math.sqrt(max(low, 0.5) * min(high, 200.0))
        rows.append((middle, Share.of(test(one) for one in inside)))
    return [row for row in rows if row[1].n]


def ideal_rate(sigma: float) -> float:
    """Return how often the ideal filter of `sigma` passes the family-wise threshold."""
    return float(norm.sf(ideal_threshold() - sigma) + norm.cdf(-ideal_threshold() - sigma))


def ideal_threshold(rate: float = 0.02) -> float:
    """Return the two-sided threshold that chance passes at `rate` over all names."""
    return float(norm.isf(rate / (2 * _LOOKS)))


def half_named_sigma(outcomes: Sequence[Outcome]) -> float:
    """Return the ideal filter's sight at which half are named.

    A logistic curve in the sight's logarithm, that may level off below 1 where names are confused,
    by maximum likelihood. NaN where all or none are named, or where it stays below a half.
    """
    x = np.log([max(one.truths[0].sigma, 1e-3) for one in outcomes])
    named = np.array([named_first(one) for one in outcomes])
    if len(named) < 4 or named.all() or not named.any():
        return math.nan
    starts = [np.array([middle, 1.0, 3.0]) for middle in (0.5, 1.2, 2.0, 3.0)]
    found = min((minimize(_misfit, start, args=(x, named), method="Nelder-Mead",
                          options={"maxiter": 2000}) for start in starts),
                key=lambda result: float(result.fun))  # fmt: skip
    middle, slope, top = found.x[0], math.exp(found.x[1]), 1.0 / (1.0 + math.exp(-found.x[2]))
    if top <= 0.5:
        return math.nan
    return float(math.exp(middle - math.log(2.0 * top - 1.0) / slope))


def _misfit(p: np.ndarray, x: np.ndarray, named: np.ndarray) -> float:
    """Return minus the log likelihood; weak priors keep perfectly parted data finite."""
    top = 1.0 / (1.0 + np.exp(-p[2]))
    rate = top / (1.0 + np.exp(-np.clip(math.exp(min(p[1], 5.0)) * (x - p[0]), -50, 50)))
    rate = np.clip(np.where(named, rate, 1.0 - rate), 1e-12, 1.0)
    prior = 0.05 * (p[1] - 1.0) ** 2 + 0.02 * (p[2] - 3.0) ** 2
    return float(-np.log(rate).sum() + prior)
