"""What faults of codes change of a recording's statistics, told by the codes' chances alone.

Beside other effects it is that about the means and the noise which these leave: whether a bit is
set hangs on where a pixel stands.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.special import pdtr, pdtrc

from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.recorded.sensor import Sensor
from calib.diagnosis.simulation.fault_codes import change_of_codes
from calib.diagnosis.simulation.fault_moments import PixelMoments
from calib.diagnosis.simulation.fault_surroundings import Surroundings
from calib.diagnosis.statistics.change import Change
from calib.diagnosis.statistics.counts import Counts, grouped
from calib.diagnosis.statistics.expected import second_moments
from calib.diagnosis.statistics.noisy import MOST_NOISY
from calib.diagnosis.statistics.pooled import Pooled
from calib.diagnosis.statistics.rare import OFTEN, RARE, SINGLE
from calib.forward.code_fault import CodeFault

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class FaultyBlock:
    """What faults change in one block.

    Attributes:
        means: Of each pixel, DN, (n_pixels,).
        squares: Its variance, DN^2, likewise.
        pooled: Of the pooled statistics, (n_pooled,).
        rare: Of the rates of what is counted, (n_rare,).
    """

    means: Floats
    squares: Floats
    pooled: Floats
    rare: Floats


def change_of_faults(faults: Sequence[CodeFault], surroundings: Surroundings) -> Change:
    """Return what `faults` change beside all else, which has left these surroundings."""
    evidence, means = surroundings.evidence, surroundings.means
    blocks = [_block(b, faults, surroundings) for b in range(len(means))]
    moved = np.stack([each.means for each in blocks])
    weight = (evidence.n - 1.0) / (evidence.n - 1.0).sum()
    ratio = sum(
        w * each.squares / v.ravel()
        for w, each, v in zip(weight, blocks, evidence.baseline.variance_dn2, strict=True)
    )
    added = np.stack([each.squares for each in blocks]).reshape(means.shape)
    codes = change_of_codes(faults, moved.reshape(means.shape), added, surroundings)
    return replace(
        no_change(evidence),
        means=moved,
        pooled=np.stack([each.pooled for each in blocks]),
        rare=np.stack([each.rare for each in blocks]),
        pixel_variance=np.asarray(ratio),
        codes=np.stack([codes, codes]),
    )


def no_change(evidence: Evidence) -> Change:
    """Return that nothing changes."""
    return evidence.observed() * 0.0


def _block(b: int, faults: Sequence[CodeFault], surroundings: Surroundings) -> FaultyBlock:
    evidence = surroundings.evidence
    n, sensor = int(evidence.n[b]), evidence.sensor
    if not surroundings.touched_by(faults, b):
        nothing, places = np.zeros(sensor.n_pixels), evidence.pooled.std.shape[1]
        return FaultyBlock(nothing, nothing, np.zeros(places), np.zeros(len(RARE)))
    after, before = surroundings.moments(faults, b), surroundings.moments_without(b)
    noise = evidence.baseline.variance_dn2[b]
    squares, fourths = after.squares - before.squares, after.fourths - before.fourths
    pooled = second_moments(squares.reshape(noise.shape), n, sensor, evidence.counts)
    _add_levels(pooled, after, sensor, evidence.counts)
    pooled["kurtosis"] = kurtosis_change(squares, fourths, noise, sensor)
    rare = _rates(after, n, sensor) - _rates(before, n, sensor)
    return FaultyBlock(after.mean - before.mean, squares, Pooled(pooled).vector(), rare)


def _add_levels(
    pooled: dict[str, Floats], moments: PixelMoments, sensor: Sensor, counts: Counts
) -> None:
    """Add what it does that samples beyond the cut are put to the level of the rest of their line.

    Where a share q of a line is out, its level has the variance v / ((1 - q) N) of the N (1 - q)
    samples that are not, v each. Of a tap with the part f of the line's pixels, the mean gains
    2 q f + q^2 f / (1 - q) of v / (f N) by that, and so does its product with another tap's.
    """
    out, inside = moments.out, np.maximum(1.0 - moments.out, 0.5)
    q, v = float(out.mean()), float((moments.squares / inside).mean())
    gained = v / (sensor.n_columns * (1.0 - q)) * (2.0 * q * (1.0 - q) + q**2)
    pooled["common"] = pooled["common"] + gained
    if counts.shared_rows:
        pooled["common_taps"] = pooled["common_taps"] + gained


def kurtosis_change(squares: Floats, fourths: Floats, noise: Floats, sensor: Sensor) -> Floats:
    """Return the change of what `pooled` calls kurtosis, (n_groups,)."""
    fourth, square = (grouped(x.reshape(noise.shape), sensor) for x in (fourths, squares))
    level, whole = (np.maximum(grouped(x, sensor), 1e-300) for x in (noise**2, noise))
    return np.asarray(fourth / 3.0 / level - 2.0 * square / whole)


def _rates(moments: PixelMoments, n: int, sensor: Sensor) -> Floats:
    """Return the rates of what is counted in a block of `n` lines, (n_rare,).

    A pixel with far more samples beyond the cut than the others is counted for itself.
    """
    rates = np.zeros(len(RARE))
    if not moments.far.any():
        return rates
    expected = n * moments.out
    typical = float(np.minimum(expected, np.median(expected) + OFTEN).mean())
    least = np.ceil(OFTEN + typical + 6.0 * np.sqrt(typical))
    track = _beside_raised(moments.raised, sensor)
    often = pdtrc(least - 1.0, expected)
    if often.mean() > MOST_NOISY:
        often, least = 0.0 * often, np.inf
    told = np.ones(sensor.n_pixels)
    told[list(sensor.noisy)] = 0.0
    # Of a Poisson number N, the mean of N below a limit is that of all times P(N < limit - 1).
    single = moments.far * (told * pdtr(least - 2.0, expected))[:, None]
    kinds = np.concatenate([[0, 1], np.arange(len(SINGLE) + 2, len(RARE))])
    rates[kinds] = (single * (1.0 - track)[:, None]).mean(axis=0)
    rates[RARE.index("tracks")] = float((single.sum(axis=1) * track).mean())
    rates[RARE.index("noisy_pixels")] = float(often.mean())
    return rates


def _beside_raised(raised: Floats, sensor: Sensor) -> Floats:
    """Return the chance that any neighbour is raised with it, of each pixel, (n_pixels,).

    Those of another tap may never be.
    """
    rows, columns = sensor.n_rows, sensor.n_columns
    calm = np.pad(np.log1p(-np.minimum(raised, 1.0 - 1e-12)).reshape(rows, columns), 1)
    around = np.zeros((rows, columns))
    for down in (0, 1, 2):
        for along in (0, 1, 2):
            if (down, along) != (1, 1):
                around += calm[down : down + rows, along : along + columns]
    return np.asarray(-np.expm1(around)).ravel()
