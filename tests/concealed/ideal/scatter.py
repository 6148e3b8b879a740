"""What additional scatter is worth: of whole samples (lines, frames), and of pixels."""

from collections.abc import Sequence

import numpy as np

from tests.concealed.generator.mechanism import Mechanism
from tests.concealed.ideal.expected import Expected
from tests.concealed.ideal.means import variance_deviance
from tests.concealed.ideal.quiet import Floats


def scatter_deviance(one: Mechanism, plain: Sequence[Expected]) -> float:
    """Return the deviance of the effects that scatter, 0 of all others."""
    if one.name == "restless_response":
        return variance_deviance(plain, [(one.strength * b.signal) ** 2 for b in plain])
    if one.name in {"line_noise", "exposure_jitter"}:
        return sum(_common(one, block) for block in plain)
    return 0.0


def _common(one: Mechanism, block: Expected) -> float:
    """2 KL of samples with a common term beside those without: n (r − ln(1 + r)).

    r is the term's variance over that of its best estimate from one sample.
    """
    n, weight = block.scan.n_samples, 1.0 / block.variance[0]
    if one.shape == "each_tap":
        taps = block.scan.sensor.taps
        each = [weight[taps == tap].sum() for tap in range(block.scan.sensor.n_taps)]
    else:
        each = [float((weight * _pattern(one, block) ** 2).sum())]
    r = one.strength**2 * np.array(each)
    return float(n * (r - np.log1p(r)).sum())


def _pattern(one: Mechanism, block: Expected) -> Floats:
    if one.name == "line_noise":
        return np.ones(block.scan.sensor.shape)
    if one.shape == "constant_time":
        share = 0.3 * block.scan.top_exposure_us / block.scan.block.exposure_us
        return np.asarray(block.signal[0] * share)
    return np.asarray(block.signal[0])
