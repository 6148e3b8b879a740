"""Goes once over a recording, block by block."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.recorded.sensor import Sensor
from calib.diagnosis.statistics.block_sums import BlockSums, Floats
from calib.diagnosis.statistics.far_samples import FarSamples, far_samples, without_one
from calib.diagnosis.statistics.jumps import FEW_LINES, without_jumps
from calib.diagnosis.statistics.neighbourhoods import about_each
from calib.diagnosis.statistics.rare import rare_events
from calib.diagnosis.statistics.repeats import repeated_lines
from calib.diagnosis.statistics.settled_mean import settled_mean
from calib.diagnosis.statistics.spectrum import power_spectrum
from calib.kernels.residual_products import residual_products
from calib.kernels.sums import line_sums
from calib.recording.protocol import Recording

CUT_SIGMA = 5.0
"""A Gaussian sample in two million lies farther out."""
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


def _by_code(samples: NDArray[np.generic], sensor: Sensor) -> NDArray[np.int64]:
    """Return the samples of each tap by code, (n_taps, n_codes)."""
    n_codes, taps = sensor.camera.full_scale_dn + 1, range(sensor.n_taps)
    parts = [samples[:, sensor.tap == tap] for tap in taps] if len(taps) > 1 else [samples]
    return np.stack([np.bincount(part.ravel(), minlength=n_codes) for part in parts])


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
    local = about_each(variance, n, sensor)
    settled, local, jumps = without_jumps(samples, variance, local, sensor)
    reach = np.maximum(samples.max(axis=0) - mean, mean - samples.min(axis=0))
    sigma = np.sqrt(settled)
    if uniform:
        # Without jumps, the farthest sample is left out already.
        rest = np.where(jumps, settled, without_one(reach, settled, n))
        sigma = _held(np.minimum(settled, rest), settled, local, n)
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
        _by_code(samples, sensor),
        power_spectrum(flat[:lines], mean.ravel(), cut.ravel()),
        lines,
        far_samples(samples, mean, reach, variance, local, products.line_means, sensor.tap)
        if uniform
        else FarSamples.none(),
    )


def _held(settled: Floats, variance: Floats, local: Floats, n: int) -> Floats:
    """Return each pixel's standard deviation in `n` lines, held near that of those about it.

    A pixel is noisier than those about it only if it is without its farthest sample, too: one of
    a hundred that lies ten standard deviations out doubles the variance.
    """
    own = 0.5 if n > FEW_LINES else 0.0
    found = np.where(variance > local, np.maximum(settled, local), variance)
    return np.asarray(np.sqrt(np.clip(found, (1.0 - own) * local, (1.0 + own) * local)))
