"""From gathered statistics to evidence: baseline, noisy pixels and common noise, in turn."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.baseline.baseline import fit_baseline
from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.evidence.growing import growing_pixels
from calib.diagnosis.evidence.jumping import jumping_pixels
from calib.diagnosis.evidence.standing_out import excess_variance
from calib.diagnosis.recorded.conditions_table import ConditionsTable
from calib.diagnosis.recorded.sensor import Sensor
from calib.diagnosis.statistics.block_sums import BlockSums
from calib.diagnosis.statistics.common_noise import CommonNoise, fit_common_noise, fit_noise_of_taps
from calib.diagnosis.statistics.counts import Counts
from calib.diagnosis.statistics.noisy import NOISY_SIGMA, beyond, few
from calib.diagnosis.statistics.pooled import places


def evidence_of(sums: Sequence[BlockSums], table: ConditionsTable, sensor: Sensor) -> Evidence:
    """Return the evidence of a recording with the baseline fitted to it."""
    baseline = fit_baseline(sums, table, sensor)
    plain = Evidence(
        tuple(sums), table, sensor, baseline, Counts.of(sensor), CommonNoise(0.0, 0.0, 1.0)
    )
    growing = growing_pixels(sums, table, sensor, baseline)
    jumping = jumping_pixels(replace(plain, growing=growing)).pixels
    growing = growing.without(jumping)
    noisy = np.union1d(np.union1d(noisy_pixels(plain), growing.pixels), jumping)
    if len(noisy) == 0:
        return replace(plain, common=_common(plain), known_peaks=plain.peaks)
    cleaned = Sensor(sensor.camera, tuple(int(p) for p in noisy))
    again = replace(
        plain,
        sensor=cleaned,
        counts=Counts.of(cleaned),
        whole=plain.space,
        growing=growing,
        known_peaks=plain.peaks,
    )
    return replace(again, common=_common(again))


def noisy_pixels(evidence: Evidence) -> NDArray[np.intp]:
    """Return the pixels whose variances or means are far off, (n,); none where they are many.

    They have to stand out of all others. What moves all of them lifts those over a limit that
    chance moved the same way: without these a strong effect of the means came out too weak.
    """
    excess = excess_variance(evidence.sums, evidence.baseline, evidence.counts)
    z = excess * np.sqrt((evidence.n - 1).sum() / 2.0)
    misfit = evidence.misfit(evidence.observed_means, observed=True)
    off = (beyond(z, z) > NOISY_SIGMA) | (beyond(misfit, misfit) > NOISY_SIGMA)
    return few(np.flatnonzero(off), len(z))


def _common(quiet: Evidence) -> CommonNoise:
    observed = quiet.pooled.observed
    where = places(quiet.sensor)
    white = np.stack([mean.of["common"].mean() for mean, _ in quiet.pooled.expected])
    taps = quiet.counts.taps_of_row
    own = observed[:, where["common"]].mean(axis=1)
    cross = observed[:, where["common_taps"]].mean(axis=1)
    excess = own / taps + cross * (taps - 1) / taps
    lags = ("common_1",) if quiet.sensor.n_rows > 1 else ("common_1", "common_2")
    lagged = np.sum([observed[:, where[lag]].mean(axis=1) for lag in lags], axis=0)
    signal = (quiet.baseline.mean_dn - quiet.baseline.offset_dn).mean(axis=(1, 2))
    freedom = (quiet.n - 1) * quiet.sensor.n_rows
    of_taps = fit_noise_of_taps(own - cross, white, freedom * (taps - 1)) if taps > 1 else 0.0
    return fit_common_noise(
        excess, lagged, white / taps, signal, freedom, n_rows=quiet.sensor.n_rows,
        of_taps_dn2=of_taps, taps=taps,
    )  # fmt: skip
