"""How likely chance makes a weighted sum of exponential variables, far out.

Power of white noise at one frequency is exponential. Weights differ, and far out the largest alone
tells how fast a sum of them dies away: gamma's law of the same mean and variance falls too fast.

Source: Lugannani and Rice, Adv. Appl. Prob. 12, 475 (1980), the saddlepoint formula; for one weight
it is off by 4 % of the probability, and for more by less.
"""

from math import log, sqrt

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.stats import norm

Floats = NDArray[np.float64]

NEAR_MEAN = 0.1
"""In standard deviations: so close to the mean the formula is 0 / 0."""


def log_chance(x: float, weights: Floats) -> float:
    """Return ln of the probability that sum w_k e_k exceeds `x`, e_k exponential of mean 1.

    The sum's cumulant generating function is K(t) = -sum ln(1 - w_k t), and K'(t) = x the
    saddlepoint. Below the mean, where nothing stands out, it is 0.

    Args:
        x: What is exceeded.
        weights: At least one above 0, (n,).
    """
    w = weights[weights > 0]
    if x <= w.sum() + NEAR_MEAN * sqrt(float((w**2).sum())):
        return 0.0
    # Here the largest weight alone makes K'(t) twice x.
    highest = 1.0 / float(w.max()) - 0.5 / x
    t = float(brentq(lambda s: float((w / (1.0 - w * s)).sum()) - x, 0.0, highest))
    root = sqrt(2.0 * (t * x + float(np.log1p(-w * t).sum())))
    u = t * sqrt(float((w**2 / (1.0 - w * t) ** 2).sum()))
    # phi(r) (1 / u - 1 / r) + Q(r), on a scale on which nothing vanishes.
    far = float(norm.logsf(root))
    density = float(norm.logpdf(root)) - far
    return far + log(max(1.0 + np.exp(density) * (1.0 / u - 1.0 / root), 1e-300))
