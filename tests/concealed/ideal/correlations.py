"""What correlations of neighbours are worth: a sum of pairs times squared correlation.

To first order in the correlation this is the deviance of a correlated Gaussian sample from an
uncorrelated one.
"""

from collections.abc import Callable, Sequence

import numpy as np

from tests.concealed.generator.mechanism import Mechanism
from tests.concealed.generator.mechanisms.transfer import Cti, Lag
from tests.concealed.ideal.expected import Expected


def correlation_deviance(one: Mechanism, plain: Sequence[Expected]) -> float:
    """Return it of the effects that correlate pixels, 0 of all others."""
    of = _BY_NAME.get(one.name)
    return sum(of(one, block) for block in plain) if of else 0.0


def _shot(block: Expected) -> float:
    """Share of shot noise in the variance."""
    variance = block.gain**2 * block.electrons
    return float((variance / block.variance).mean())


def _directions(block: Expected) -> int:
    return 2 if block.scan.sensor.area else 1


def _capacitance(one: Mechanism, block: Expected) -> float:
    rho, n = 2 * one.strength * _shot(block), block.dn.size * _directions(block)
    share = {"nearest": 1.0, "second_neighbours": 1.25, "columns_only_half": 0.5}[one.shape]
    return n * share * rho**2


def _crosstalk(one: Mechanism, block: Expected) -> float:
    share = {"mutual": 4 * 0.5, "one_way": 0.5, "previous_pixel": 1.0}[one.shape]
    return float(block.dn.size * share * one.strength**2)


def _brighter_fatter(one: Mechanism, block: Expected) -> float:
    rho = one.strength * float(block.electrons.mean()) * _shot(block)
    share = {"plain": 1.0, "far_reaching": 1.25, "one_sided": 1.0}[one.shape]
    return block.dn.size * _directions(block) * share * rho**2


def _lag(one: Mechanism, block: Expected) -> float:
    assert isinstance(one, Lag)
    if one.shape == "incomplete_reset":
        return float(block.dn.size * (one.strength * _shot(block)) ** 2)
    charge = np.array([max(float(block.electrons.mean()), 1.0)])
    excess = _beyond_thinning(lambda q: q * one.strength * np.asarray(one.relative(q)), charge)
    return float(block.dn.size * (excess[0] * _shot(block)) ** 2)


def _cti(one: Mechanism, block: Expected) -> float:
    assert isinstance(one, Cti)
    charge = np.maximum(block.electrons.mean(axis=(0, 1)), 1.0)
    excess = _beyond_thinning(lambda q: q * one.share(q), charge)
    n_transfers = np.zeros(charge.size)
    for columns in block.scan.sensor.registers:
        n_transfers[columns] = np.arange(1, len(columns) + 1)
    rho = np.clip(excess * n_transfers * _shot(block), -0.5, 0.5)
    return float(block.dn[:, :, 0].size * (rho**2).sum())


def _beyond_thinning(lost: Callable[[np.ndarray], np.ndarray], charge: np.ndarray) -> np.ndarray:
    """Return the covariance of loss and rest over the charge: lost'(q) − lost(q)/q.

    Electrons that go by a chance of their own leave Poisson counts independent.
    """
    step = 1e-3 * charge
    slope = (lost(charge + step) - lost(charge - step)) / (2 * step)
    return np.asarray(slope - lost(charge) / charge)


_BY_NAME: dict[str, Callable[[Mechanism, Expected], float]] = {
    "interpixel_capacitance": _capacitance,
    "tap_crosstalk": _crosstalk,
    "brighter_fatter": _brighter_fatter,
    "lag": _lag,
    "cti": _cti,
}
