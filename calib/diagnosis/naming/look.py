"""One way of looking at what no effect explains, and how far from chance it is."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2, norm

Floats = NDArray[np.float64]

IMPERFECT_SHARE = 0.01
"""Of the deviance explained: signatures are not exact, and leave this much behind."""


@dataclass(frozen=True)
class Look:
    """One way of looking at a remainder.

    Attributes:
        statistic: In which it shows, as the answer calls it.
        depends_on: What it follows.
        deviance: Squared length.
        freedom: What chance gives on average.
        blocks: By how much each block contributes, (n_blocks,).
    """

    statistic: str
    depends_on: tuple[str, ...]
    deviance: float
    freedom: float
    blocks: Floats

    def sigma(self, explained: float, looks: int) -> float:
        """Return how far from chance it is, in standard deviations, all looks counted."""
        deviance = self.deviance - IMPERFECT_SHARE * explained
        # Of one signal and a dark nothing is left of the means, and nothing is to be judged.
        if self.freedom <= 0 or deviance <= self.freedom:
            return 0.0
        log_p = float(chi2.logsf(deviance, self.freedom)) + float(np.log(looks))
        if log_p < -600.0:
            return float(np.sqrt(deviance - self.freedom))
        return float(max(norm.isf(np.exp(min(log_p, -1e-9))), 0.0))
