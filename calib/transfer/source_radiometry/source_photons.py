"""How many photons a source sends through the aperture, and how sure that is."""

from dataclasses import dataclass
from math import sqrt
from typing import Any

import numpy as np
from numpy.random import Generator

from calib.budget import Budget, BudgetRow
from calib.errors import InputError
from calib.transfer.estimate import Estimate
from calib.transfer.source_radiometry.diverging_source import (
    DivergingSource,
    photons_through_aperture,
)

FEWEST_DRAWS = 1000
"""Of fewer, the ends of an interval say little."""
_STEP = 1e-4  # of an input, for its sensitivity


@dataclass(frozen=True)
class SourcePhotons:
    """Expected photons of one exposure.

    Attributes:
        nominal: Of the nominal inputs.
        low, high: With every input at its worst bound: nothing lies outside.
        estimate: Mean and standard deviation over inputs drawn from between their bounds. The mean
            is not quite `nominal`: bounds may be lopsided, and Eq. 21 is curved.
        interval: Between which the share `coverage` of those draws lies, as many beyond either end.
        coverage: Of `interval`.
        budget: What each input brings in, to first order.
        n_draws: How many were drawn.
    """

    nominal: float
    low: float
    high: float
    estimate: Estimate
    interval: tuple[float, float]
    coverage: float
    budget: Budget
    n_draws: int

    @property
    def monte_carlo_relative_std(self) -> float:
        """Relative standard error of `estimate.std` that comes from the number of draws alone."""
        return 1.0 / sqrt(2.0 * (self.n_draws - 1))

    def answer(self) -> dict[str, Any]:
        """Return it as JSON has it."""
        return {
            "photons": {**self.estimate.answer(), "nominal": self.nominal},
            "bounds": [self.low, self.high],
            "interval": {"low": self.interval[0], "high": self.interval[1], "of": self.coverage},
            "budget": [
                {"quantity": r.quantity, "std": r.value, "unit": r.unit, "photons": r.contribution}
                for r in self.budget.rows
            ],
            "monte_carlo_draws": self.n_draws,
        }


def source_photons(
    source: DivergingSource, rng: Generator, *, n_draws: int = 200_000, coverage: float = 0.95
) -> SourcePhotons:
    """Return the photons of `source`, by interval and by Monte Carlo.

    Source: JCGM 101:2008, propagation of distributions by a Monte Carlo method; the interval is
    the probabilistically symmetric one of its section 7.7.

    Args:
        source: The inputs; independent of one another, each rectangular between its bounds.
        rng: Where the draws come from.
        n_draws: How many.
        coverage: Probability that the interval holds, between 0 and 1.
    """
    if n_draws < FEWEST_DRAWS or not 0 < coverage < 1:
        raise InputError(
            f"{n_draws} draws for a coverage of {coverage}: give {FEWEST_DRAWS} or more, and a "
            "coverage between 0 and 1.",
            code="bad-monte-carlo",
        )
    drawn = photons_through_aperture(
        **{name: given.drawn(n_draws, rng) for name, given in source.inputs().items()}
    )
    low, high = source.corners()
    ends = np.quantile(drawn, [(1 - coverage) / 2, (1 + coverage) / 2])
    return SourcePhotons(
        nominal=source.nominal(),
        low=low,
        high=high,
        estimate=Estimate(float(drawn.mean()), float(drawn.std(ddof=1)), "photon"),
        interval=(float(ends[0]), float(ends[1])),
        coverage=coverage,
        budget=_budget(source),
        n_draws=n_draws,
    )


def _budget(source: DivergingSource) -> Budget:
    """Return each input's standard uncertainty and the slope of the photons against it."""
    values = {name: given.value for name, given in source.inputs().items()}
    rows = []
    for name, given in source.inputs().items():
        if given.std == 0:
            continue
        step = _STEP * given.value
        above, below = ({**values, name: given.value + sign * step} for sign in (1, -1))
        rise = photons_through_aperture(**above) - photons_through_aperture(**below)
        rows.append(
            BudgetRow(name, "B", "rectangular", given.std, given.unit, float(rise / (2 * step)))
        )
    return Budget("photons", "photon", tuple(rows))
