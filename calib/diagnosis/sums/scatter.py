"""How sure it is that sums scatter by more than statistics allow."""

import numpy as np
from scipy.stats import chi2, norm

from calib.transfer.photon_transfer.overdispersion import Excess


def scatter_sigma(found: Excess) -> float:
    """Return how far from chance the scatter is, in standard deviations."""
    if found.freedom < 1:
        return 0.0
    log_p = float(chi2.logsf(found.chi_squared, found.freedom))
    if log_p < -600.0:
        return float(np.sqrt(found.chi_squared - found.freedom))
    return float(max(norm.isf(np.exp(min(log_p, -1e-9))), 0.0))
