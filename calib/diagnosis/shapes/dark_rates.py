"""Dark current whose rates the recording itself tells, pixel by pixel.

Rates need not scatter about a mean as a normal variable does: of a sensor with few defects in each
pixel they are exponential (McColgin et al., Dark current quantization in CCD image sensors, IEDM
1992). What each pixel gathers per time is fitted to the residual of the baseline, beside an offset
and a slope of its own, and pays for as many numbers. They are looked for where neighbours differ by
more than that: what they have in common is no pixel's own, and what few have, hot pixels.
"""

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.evidence.growing import fitted_growth
from calib.diagnosis.shapes.shape import Shape
from calib.diagnosis.simulation.with_values import with_values
from calib.forward.departure import Departure
from calib.forward.effects.dark_current import DarkCurrent
from calib.forward.effects.dark_current_temperature import DarkCurrentTemperature

Floats = NDArray[np.float64]

CLEAR = 16.0
"""Deviance by which differences have to exceed twice what chance makes of them."""
MOST_OF_ONE = 4.0
"""Of a difference: few that are larger are hot pixels."""
BY_CHANCE = 0.92
"""Of a squared standard normal number that is cut there, on average."""
MOST_PIXELS = 16_384
"""Of more, rates are no list that an answer can hold."""
DOUBLINGS_K = (4.0, 5.0, 6.0, 7.0, 8.5, 11.0)
"""Rises of the temperature that are tried."""


def dark_rate_shapes(kind: type[Departure], evidence: Evidence) -> tuple[Shape, ...]:
    """Return an effect at each pixel's own rate; none where it has no such, or none is told."""
    if evidence.sensor.n_pixels > MOST_PIXELS:
        return ()
    if kind is DarkCurrent:
        plain = DarkCurrent(electrons_per_us=0.0, dsnu_std_e_per_us=0.0)
        return _told(plain, evidence.table.exposure_us, evidence)
    if kind is not DarkCurrentTemperature:
        return ()
    found: tuple[Shape, ...] = ()
    for doubling in DOUBLINGS_K:
        warm = DarkCurrentTemperature(0.0, 0.0, doubling_k=doubling)
        warmth = (evidence.table.temperature_c - warm.reference_c) / doubling
        found += _told(warm, evidence.table.exposure_us * 2.0**warmth, evidence)
    return found


def _told(
    plain: DarkCurrent | DarkCurrentTemperature, exposure_us: Floats, evidence: Evidence
) -> tuple[Shape, ...]:
    """Return the effect with the rates that follow what counts as exposures, (n_blocks,)."""
    if not np.isfinite(exposure_us).all():
        return ()
    growth, std = growth_dn(exposure_us, evidence)
    told = np.isfinite(std)
    if not _differ(growth[told], std[told]):
        return ()
    rates = np.where(told, np.maximum(growth, 0.0), 0.0)
    gain = evidence.baseline.gain_dn_per_e[evidence.sensor.tap].ravel()
    rates /= np.where(gain > 0, gain, 1.0) * float(exposure_us.max())
    unit, mean = tuple(rates.tolist()), float(rates.mean())
    template = with_values(plain, {"electrons_per_us": mean, "rates_e_per_us": unit})
    varied = (("electrons_per_us", mean, 0.0), ("rates_e_per_us", unit, 0.0))
    return (Shape(template, varied, two_sided=False, freedom=float(told.sum())),)


def _differ(growth: Floats, std: Floats) -> bool:
    """Return whether neighbours differ by more than twice as much as chance makes them."""
    pairs = len(growth) // 2
    if pairs == 0:
        return False
    one, other = slice(0, 2 * pairs, 2), slice(1, 2 * pairs, 2)
    deviance = (growth[one] - growth[other]) ** 2 / (std[one] ** 2 + std[other] ** 2)
    return float(np.minimum(deviance, MOST_OF_ONE).sum()) > 2.0 * BY_CHANCE * pairs + CLEAR


def growth_dn(exposure_us: Floats, evidence: Evidence) -> tuple[Floats, Floats]:
    """Return what each pixel gains in the longest exposure, DN, (n_pixels,), and its std."""
    means, base = evidence.observed_means, evidence.baseline
    variance, usable = base.variance_dn2.reshape(means.shape), base.usable.reshape(means.shape)
    weight = np.where(usable, evidence.n[:, None] / variance, 0.0)
    dose = base.dose.reshape(means.shape)
    growth, std, _ = fitted_growth(means, weight, dose, exposure_us)
    return growth, std
