"""The plain model fitted to a recording: offset and slope of each pixel, gain and read noise."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.recorded.conditions_table import ConditionsTable
from calib.diagnosis.recorded.sensor import Sensor
from calib.diagnosis.statistics.block_sums import BlockSums
from calib.rounding import mean_square_bias

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]

CLEAR_SIGMA = 4.5
"""A pixel's mean stands so many standard deviations away from the ends of the codes, or more."""
ROUNDS = 3
MOSTLY_QUIET = 0.5
"""Pixels with samples far out are left out of the noise, unless they are more than this share."""
PILED = 1.2
"""A lowest code that is so much commoner than the next ones is a stop, no tail."""


@dataclass(frozen=True)
class Baseline:
    """DN = L VE QE t + DN0, shot noise of one system gain, Gaussian read noise.

    Attributes:
        offset_dn: (n_rows, n_columns).
        slope: DN per radiance us, (n_rows, n_columns).
        gain_dn_per_e: System gain, (n_taps,).
        read_variance_dn2: With 1/12 for rounding, (n_taps,).
        dose: Radiance times exposure, radiance us, (n_blocks, n_rows, n_columns).
        mean_dn: What each pixel of each block should give, (n_blocks, n_rows, n_columns).
        variance_dn2: Of its samples, likewise.
        usable: Where codes are far from both of their ends, likewise.
    """

    offset_dn: Floats
    slope: Floats
    gain_dn_per_e: Floats
    read_variance_dn2: Floats
    dose: Floats
    mean_dn: Floats
    variance_dn2: Floats
    usable: Flags


def fit_baseline(sums: Sequence[BlockSums], table: ConditionsTable, sensor: Sensor) -> Baseline:
    """Return the fit of all blocks."""
    mean = np.stack([each.mean_dn for each in sums])
    clipped = np.stack([each.clipped for each in sums])
    dose = table.dose_of((sensor.n_rows, sensor.n_columns))
    usable = clipped == 0.0
    floor_dn = lowest_pile(sums)
    if floor_dn > 0:
        usable &= mean > floor_dn + 3.0
    variance = np.stack([_smooth_variance(each, sensor) for each in sums])
    n = np.array([each.n_lines for each in sums], np.float64)
    for _ in range(ROUNDS):
        weight = np.where(usable, n[:, None, None] / variance, 0.0)
        offset, slope = fit_lines(mean, dose, weight)
        expected = offset + slope * dose
        gain, read = fit_noise(sums, expected - offset, usable, variance, sensor)
        straight = np.maximum(
            read[sensor.tap] + gain[sensor.tap] * (expected - offset), 0.3 * read[sensor.tap]
        )
        # A line drawn by rays may leave less than a sensor without noise has.
        straight = np.maximum(straight, 1.0 / 12.0)
        variance = straight - hidden_by_rounding(straight)
        reach = CLEAR_SIGMA * np.sqrt(variance) + 0.5
        inside = (expected > floor_dn + reach) & (expected < sensor.camera.full_scale_dn - reach)
        usable = inside & (clipped < 1e-2)
    return Baseline(offset, slope, gain, read, dose, expected, variance, usable)


def hidden_by_rounding(straight: Floats) -> Floats:
    """Return what is missing of the variance of codes to that of noise and 1/12, DN^2.

    It is the mean square of rounding's bias over all phases of the mean (`calib.rounding`): nothing
    at half a DN of noise, 0.016 at 0.175. Left out, it falls with the signal, and gain comes out
    too high.
    """
    return np.asarray(mean_square_bias(np.sqrt(np.maximum(straight - 1.0 / 12.0, 0.0))))


def unrounded(variance_dn2: float) -> float:
    """Return the variance of noise and 1/12 that gives codes this variance, over all phases."""
    noise = np.linspace(0.0, 1.0, 1001)
    straight = noise**2 + 1.0 / 12.0
    seen = straight - hidden_by_rounding(straight)
    found = np.interp(variance_dn2, seen, straight)
    return float(found) if variance_dn2 < seen[-1] else float(variance_dn2)


def lowest_pile(sums: Sequence[BlockSums]) -> int:
    """Return the code at which all lower ones pile up, 0 where there is no such above 0.

    The tail of a distribution thins out; a lowest code that is commoner than the next is a stop.
    """
    histogram = np.sum([each.histogram for each in sums], axis=0)
    low = int(np.flatnonzero(histogram)[0])
    piled = histogram[low] > PILED * max(histogram[low + 1 : low + 3].max(initial=0), 30)
    return low if piled else 0


def fit_lines(mean: Floats, dose: Floats, weight: Floats) -> tuple[Floats, Floats]:
    """Return offset and slope of each pixel by weighted least squares.

    Where one dose alone has weight, all of the mean is taken for offset in the dark, and for
    slope in the light.

    Args:
        mean: (n_blocks, n_rows, n_columns).
        dose: Likewise.
        weight: Likewise.
    """
    x = dose / max(float(dose.max()), 1e-300)
    s0 = weight.sum(axis=0)
    s1 = (x * weight).sum(axis=0)
    s2 = (x * x * weight).sum(axis=0)
    y0 = (weight * mean).sum(axis=0)
    y1 = (x * weight * mean).sum(axis=0)
    determinant = s0 * s2 - s1 * s1
    fine = determinant > 1e-10 * np.maximum(s0 * s2, 1e-300)
    safe = np.where(fine, determinant, 1.0)
    slope = np.where(fine, (s0 * y1 - s1 * y0) / safe, 0.0)
    alone = ~fine & (s2 > 0)
    slope = np.where(alone, y1 / np.where(s2 > 0, s2, 1.0), slope)
    offset = np.where(fine, (s2 * y0 - s1 * y1) / safe, 0.0)
    dark_only = ~fine & (s2 <= 0) & (s0 > 0)
    offset = np.where(dark_only, y0 / np.where(s0 > 0, s0, 1.0), offset)
    return offset, slope / max(float(dose.max()), 1e-300)


def fit_noise(
    sums: Sequence[BlockSums], signal: Floats, usable: Flags, variance: Floats, sensor: Sensor
) -> tuple[Floats, Floats]:
    """Return system gain and read variance of each tap from variance against signal.

    The line is that of noise and 1/12: what rounding hides of it is put back.
    """
    gain, read = np.zeros(sensor.n_taps), np.zeros(sensor.n_taps)
    for tap in range(sensor.n_taps):
        of_tap = sensor.tap == tap
        size = of_tap.sum() / of_tap.any(axis=1).sum()
        rows = []
        for b, each in enumerate(sums):
            use = usable[b] & of_tap
            quiet = use & (each.products.outliers == 0)
            # Where samples of most pixels jump, those that are left tell the noise.
            use = quiet if quiet.sum() > MOSTLY_QUIET * use.sum() else use
            if not use.any() or each.n_lines < 2:
                continue
            kept = each.n_lines - 1 - each.products.outliers[use].mean()
            scale = kept * (1.0 - 1.0 / size)
            measured = unrounded(each.products.squares[use].mean() / scale)
            std = np.sqrt(2.0 / (scale * use.sum())) * variance[b][use].mean()
            rows.append((signal[b][use].mean(), measured, std))
        gain[tap], read[tap] = _noise_line(np.array(rows).reshape(-1, 3))
    return gain, read


def _noise_line(rows: Floats) -> tuple[float, float]:
    """Return slope and intercept of (signal, variance, std) rows; neither is negative."""
    if len(rows) == 0:
        return 0.0, 1.0
    s, v, std = rows.T
    design = np.stack([s, np.ones_like(s)], axis=1) / std[:, None]
    if np.ptp(s) <= 1e-6 * max(float(np.abs(s).max()), 1.0):
        return 0.0, float(np.average(v, weights=1 / std**2))
    k, r = np.linalg.lstsq(design, v / std, rcond=None)[0]
    if r < 0.02:
        r = 0.02
        k = float(np.sum((v - r) * s / std**2) / np.sum(s**2 / std**2))
    return max(float(k), 0.0), float(r)


def _smooth_variance(each: BlockSums, sensor: Sensor) -> Floats:
    """Return the block's variance, averaged over each tap, for the first round's weights."""
    smooth = np.empty_like(each.mean_dn)
    for tap in range(sensor.n_taps):
        of_tap = sensor.tap == tap
        pooled = np.median(each.products.squares[of_tap]) / max(each.n_lines - 1, 1)
        smooth[of_tap] = max(float(pooled), 0.05)
    return smooth
