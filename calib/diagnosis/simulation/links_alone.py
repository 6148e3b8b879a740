"""What links that have moved change without any effect: told by their law, nothing is drawn.

Drawn lines have chance products, of a hundredth of the noise. Where codes stop, hardly any of the
noise is left, and products scatter by less than that.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.baseline.baseline import Baseline
from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.simulation.fault_change import kurtosis_change, no_change
from calib.diagnosis.statistics.change import Change
from calib.diagnosis.statistics.expected import second_moments
from calib.diagnosis.statistics.pooled import Pooled

Floats = NDArray[np.float64]


def change_of_links(now: Baseline, evidence: Evidence) -> Change:
    """Return what offsets, slopes, gains and read noise of `now` change of the baseline's."""
    base, sensor = evidence.baseline, evidence.sensor
    means = now.offset_dn + now.slope * now.dose - base.mean_dn
    variance = _variance(now, sensor.tap) - _variance(base, sensor.tap)
    pooled = []
    for n, moved, noise in zip(evidence.n, variance, base.variance_dn2, strict=True):
        each = second_moments(moved, int(n), sensor, evidence.counts)
        fourths = 3.0 * moved * (2.0 * noise + moved)
        each["kurtosis"] = kurtosis_change(moved, fourths, noise, sensor)
        pooled.append(Pooled(each).vector())
    weight = (evidence.n - 1.0) / (evidence.n - 1.0).sum()
    ratio = np.tensordot(weight, variance / base.variance_dn2, 1)
    return replace(
        no_change(evidence),
        means=means.reshape(len(means), -1),
        pooled=np.stack(pooled),
        pixel_variance=ratio.ravel(),
    )


def _variance(links: Baseline, tap: NDArray[np.intp]) -> Floats:
    """Return each pixel's variance, DN^2, (n_blocks, n_rows, n_columns)."""
    signal = np.maximum(links.slope * links.dose, 0.0)
    return np.asarray(links.read_variance_dn2[tap] + links.gain_dn_per_e[tap] * signal)
