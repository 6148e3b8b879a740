"""Goes once over a recording, block by block."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.recorded.sensor import Sensor
from calib.diagnosis.statistics.block_sums import BlockSums, Floats
from calib.diagnosis.statistics.far_samples import FarSamples, far_samples, without_one
from calib.diagnosis.statistics.rare import rare_events
from calib.diagnosis.statistics.repeats import repeated_lines
from calib.diagnosis.statistics.settled_mean import settled_mean
from calib.diagnosis.statistics.spectrum import power_spectrum
from calib.kernels.residual_products import residual_products
from calib.kernels.sums import line_sums
from calib.recording.protocol import Recording

FEW_LINES = 16
"""Of so few, or fewer, no pixel's own variance tells its noise."""
MEDIAN_OF_NORMAL = 0.6745
"""Median of the absolute values of a standard normal variable."""
CUT_SIGMA = 5.0
"""A Gaussian sample in two million lies farther out."""
NEIGHBOURHOODS = 32
"""Of columns, in which a pixel's noise is compared with others'."""
MEDIAN_LINES = 64
"""Of so many lines a pixel's median tells how its samples scatter but for those that jump."""
WIDE = 1.5
"""Where samples jump, their variance is larger by this factor than the median tells, or more."""
MOST_SAMPLES = 1 << 26
"""Of a block: so many are looked at, 128 MiB; what comes after adds little."""
SPECTRUM_SAMPLES = 1 << 25
"""All blocks' spectra together hold at most so many samples."""


def gather(
    recording: Recording, *, progress: Callable[[float], None] = lambda _: None
) -> tuple[BlockSums, ...]:
    """Return the statistics of each block of `recording`, in their order."""
    sensor = Sensor(recording.header.camera)
    blocks = recording.header.blocks
    gathered = []
    for k, block in enumerate(blocks):
        samples = _samples(recording, block.block, sensor)
        most, uniform = SPECTRUM_SAMPLES // len(blocks), block.kind != "scene"
        gathered.append(block_sums(samples, sensor, most, uniform=uniform))
        progress((k + 1) / len(blocks))
    return tuple(gathered)


def _samples(recording: Recording, name: str, sensor: Sensor) -> NDArray[np.generic]:
    """Return the block's codes, (n_lines, n_rows, n_columns)."""
    most = max(2, MOST_SAMPLES // sensor.n_pixels)
    parts, n = [], 0
    for dn in recording.frames(name):
        parts.append(dn[: most - n])
        n += len(parts[-1])
        if n >= most:
            break
    joined = parts[0] if len(parts) == 1 else np.concatenate(parts)
    return joined.reshape(len(joined), sensor.n_rows, sensor.n_columns)


def block_sums(
    samples: NDArray[np.generic], sensor: Sensor, spectrum_samples: int, *, uniform: bool = True
) -> BlockSums:
    """Return the statistics of codes, (n_lines, n_rows, n_columns), of `uniform` light or not."""
    repeated = repeated_lines(samples)
    # A line that comes twice tells nothing of its own.
    samples = samples[~repeated] if repeated.any() else samples
    n = len(samples)
    flat = np.ascontiguousarray(samples.reshape(n, -1))
    sums = line_sums(flat, sensor.camera.full_scale_dn)
    shape = samples.shape[1:]
    mean = sums.mean_dn.reshape(shape)
    variance = np.maximum(np.nan_to_num(sums.variance_dn2).reshape(shape), 0.1)
    # Where the light has edges, a pixel's noise is unlike that of those about it.
    local = _local(variance, n, sensor)
    settled, local = without_jumps(samples, variance, local, sensor)
    reach = np.maximum(samples.max(axis=0) - mean, mean - samples.min(axis=0))
    sigma = np.sqrt(settled)
    if uniform:
        sigma = _held(np.minimum(settled, without_one(reach, settled, n)), settled, local, n)
    cut = CUT_SIGMA * sigma + 1.0
    products = residual_products(samples, mean, cut, sensor.tap, sensor.n_taps, sensor.partner)
    if products.outliers.any():
        mean = settled_mean(samples, mean, cut, products.outliers)
        products = residual_products(samples, mean, cut, sensor.tap, sensor.n_taps, sensor.partner)
    mean = mean + products.total / n
    lines = min(n, max(2, spectrum_samples // sensor.n_pixels))
    return BlockSums(
        n,
        mean,
        ((sums.at_zero + sums.at_full_scale) / n).reshape(shape),
        variance,
        products,
        sigma,
        rare_events(samples, mean, sigma, products.outliers, int(repeated.sum())),
        np.bincount(flat.ravel(), minlength=sensor.camera.full_scale_dn + 1),
        power_spectrum(flat[:lines], mean.ravel(), cut.ravel()),
        lines,
        far_samples(samples, mean, reach, variance, local, products.line_means, sensor.tap)
        if uniform
        else FarSamples.none(),
    )


def without_jumps(
    samples: NDArray[np.generic], variance: Floats, local: Floats, sensor: Sensor
) -> tuple[Floats, Floats]:
    """Return pixels' variances, and their neighbourhoods', without samples that jump far away.

    A bit that sticks in one sample of ten triples what its pixel seems to scatter by, and no jump
    stands out of that. The median of deviations from the median (Hampel, J. Am. Stat. Assoc. 69,
    383 (1974)) knows nothing of fewer than half of the samples; half a code is added, by which
    whole codes hide it. It takes the variance's place where that is wider by far.

    Args:
        samples: Codes, (n_lines, n_rows, n_columns).
        variance: Of each pixel, DN^2, (n_rows, n_columns).
        local: Of those about each, likewise.
        sensor: The sensor.
    """
    if len(samples) <= FEW_LINES:
        return variance, local
    few = samples[:: -(-len(samples) // MEDIAN_LINES)].astype(np.float64)
    off = np.abs(few - np.median(few, axis=0))
    settled = ((np.median(off, axis=0) + 0.5) / MEDIAN_OF_NORMAL) ** 2
    about = _middles(settled, sensor)
    jumps = local > WIDE * about
    return np.where(jumps, about, variance), np.where(jumps, about, local)


def _held(settled: Floats, variance: Floats, local: Floats, n: int) -> Floats:
    """Return each pixel's standard deviation in `n` lines, held near that of those about it.

    A pixel is noisier than those about it only if it is without its farthest sample, too: one of
    a hundred that lies ten standard deviations out doubles the variance.
    """
    own = 0.5 if n > FEW_LINES else 0.0
    found = np.where(variance > local, np.maximum(settled, local), variance)
    return np.asarray(np.sqrt(np.clip(found, (1.0 - own) * local, (1.0 + own) * local)))


def _local(variance: Floats, n: int, sensor: Sensor) -> Floats:
    """Return the variance that the pixels of its tap about each have in the middle of them."""
    # The median of chi-squared over its mean (Wilson and Hilferty), far below 1 for few lines.
    return _middles(variance, sensor) / (1.0 - 2.0 / (9.0 * max(n - 1, 1))) ** 3


def _middles(variance: Floats, sensor: Sensor) -> Floats:
    """Return the median over the pixels of its tap about each, 0.1 DN^2 or more."""
    found = np.empty_like(variance)
    columns = np.arange(sensor.n_columns)
    edges = np.linspace(0, sensor.n_columns, min(NEIGHBOURHOODS, sensor.n_columns // 8 + 1) + 1)
    middles, bounds = (edges[1:] + edges[:-1]) / 2, edges.astype(int)
    for tap in range(sensor.n_taps):
        of_tap = sensor.tap == tap
        known = [
            (x, max(float(np.median(variance[:, a:b][of_tap[:, a:b]])), 0.1))
            for x, a, b in zip(middles, bounds[:-1], bounds[1:], strict=True)
            if of_tap[:, a:b].any()
        ]
        local = np.interp(columns, [x for x, _ in known], [v for _, v in known])
        found[of_tap] = np.broadcast_to(local, variance.shape)[of_tap]
    return found
