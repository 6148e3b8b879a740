"""What correlations of neighbours are worth: a sum of pairs times squared correlation.

To first order in the correlation this is the deviance of a correlated Gaussian sample from an
uncorrelated one.
"""

from collections.abc import Callable, Sequence

import numpy as np

from tests.concealed.generator.mechanism import Mechanism
from tests.concealed.generator.mechanisms.transfer import Cti, Lag
from tests.concealed.ideal.expected import Expected
from tests.concealed.ideal.quiet import Floats

Correlations = dict[str, Floats]
"""By kind of neighbour ("next column", "next sample", …): of each column, (n_columns,)."""


def correlation_deviance(one: Mechanism, plain: Sequence[Expected]) -> float:
    """Return it of the effects that correlate pixels, 0 of all others."""
    return float(sum((each**2).sum() for each in correlation_signature(one, plain).values()))


def correlation_signature(one: Mechanism, plain: Sequence[Expected]) -> Correlations:
    """Return correlations over their standard errors, by kind, (n_blocks, n_columns)."""
    of = _BY_NAME.get(one.name)
    if of is None:
        return {}
    rows = [
        {kind: np.sqrt(_n(block)) * rho for kind, rho in of(one, block).items()} for block in plain
    ]
    return {kind: np.stack([row[kind] for row in rows]) for kind in rows[0]}


def _n(block: Expected) -> int:
    """Pairs of pixels of one column."""
    return block.scan.n_samples * block.scan.sensor.rows


def _shot(block: Expected) -> Floats:
    """Share of shot noise in each column's variance."""
    variance = block.gain**2 * block.electrons
    return np.asarray((variance / block.variance).mean(axis=(0, 1)))


def _charge(block: Expected) -> Floats:
    return np.asarray(np.maximum(block.electrons.mean(axis=(0, 1)), 1.0))


def _capacitance(one: Mechanism, block: Expected) -> Correlations:
    rho = 2 * one.strength * _shot(block)
    if one.shape == "columns_only_half":
        return {"next column": rho * (np.arange(rho.size) % 2)}
    nearest = {"next column": rho, **({"next row": rho} if block.scan.sensor.area else {})}
    if one.shape == "second_neighbours":
        nearest["next but one column"] = 0.5 * rho
    return nearest


def _crosstalk(one: Mechanism, block: Expected) -> Correlations:
    sensor = block.scan.sensor
    own = np.arange(sensor.columns)
    pair = (own < sensor.partner).astype(float)  # each pair once
    kind = "next column" if sensor.layout == "odd_even" else "partner"
    if one.shape == "previous_pixel":
        return {"partner of the column before": np.full(own.size, one.strength)}
    return {kind: pair * one.strength * (2.0 if one.shape == "mutual" else 1.0)}


def _brighter_fatter(one: Mechanism, block: Expected) -> Correlations:
    rho = one.strength * _charge(block) * _shot(block)
    found = {"next column": rho, **({"next row": rho} if block.scan.sensor.area else {})}
    if one.shape == "far_reaching":
        found["next but one column"] = 0.5 * rho
    return found


def _lag(one: Mechanism, block: Expected) -> Correlations:
    assert isinstance(one, Lag)
    if one.shape == "incomplete_reset":
        return {"next sample": one.strength * _shot(block)}
    excess = _beyond_thinning(
        lambda q: q * one.strength * np.asarray(one.relative(q)), _charge(block)
    )
    return {"next sample": excess * _shot(block)}


def _cti(one: Mechanism, block: Expected) -> Correlations:
    assert isinstance(one, Cti)
    excess = _beyond_thinning(lambda q: q * one.share(q), _charge(block))
    n_transfers = np.zeros(block.scan.sensor.columns)
    for columns in block.scan.sensor.registers:
        n_transfers[columns] = np.arange(1, len(columns) + 1)
    rho = np.clip(excess * n_transfers * _shot(block), -0.5, 0.5)
    kind = "next column" if block.scan.sensor.layout != "odd_even" else "next but one column"
    return {kind: rho}


def _beyond_thinning(lost: Callable[[Floats], Floats], charge: Floats) -> Floats:
    """Return the covariance of loss and rest over the charge: lost'(q) − lost(q)/q.

    Electrons that go by a chance of their own leave Poisson counts independent.
    """
    step = 1e-3 * charge
    slope = (lost(charge + step) - lost(charge - step)) / (2 * step)
    return np.asarray(slope - lost(charge) / charge)


_BY_NAME: dict[str, Callable[[Mechanism, Expected], Correlations]] = {
    "interpixel_capacitance": _capacitance,
    "tap_crosstalk": _crosstalk,
    "brighter_fatter": _brighter_fatter,
    "lag": _lag,
    "cti": _cti,
}
