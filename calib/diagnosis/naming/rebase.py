"""The baseline fitted anew beside effects: what it had taken of them for its own goes back.

A baseline that is fitted alone bends to what it does not know: nonlinearity flattens its slopes,
capacitance lowers its gain. The strength of an effect is then that about the wrong baseline, off
by about its own size relative to what is bent. Here offsets, slopes, gains and read noise step to
where baseline and effects together fit the recording (Newton, the effects' own part in the
derivative left out: it is small, and the steps are repeated).
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.baseline.baseline import Baseline, fit_lines
from calib.diagnosis.baseline.expected_codes import own_means_hidden
from calib.diagnosis.baseline.nuisance import scene_blocks
from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.statistics.change import Change
from calib.diagnosis.statistics.counts import grouped

Floats = NDArray[np.float64]

FARTHEST = 2.0
"""A gain may move by this factor at a time."""
LEAST_READ_DN2 = 0.02


def rebased(now: Baseline, missed: Change, evidence: Evidence) -> Baseline:
    """Return the links of `now` one step on, towards where `missed` holds nothing of them.

    What the statistics are compared with, `mean_dn`, `variance_dn2` and `usable`, stays.

    Args:
        now: The links beside which the effects were simulated.
        missed: What was recorded less what `now` with the effects gives.
        evidence: The recording.
    """
    first = evidence.baseline
    told = first.usable & ~scene_blocks(evidence.table)[:, None, None]
    weight = np.where(told, evidence.n[:, None, None] / first.variance_dn2, 0.0)
    means = missed.means.reshape(first.mean_dn.shape)
    offset, slope = fit_lines(means, first.dose, weight)
    gain, read = _noise_step(now, missed, evidence)
    scale = np.where(now.gain_dn_per_e > 0, now.gain_dn_per_e, 1.0)
    moved = scale * np.clip(1.0 + gain / scale, 1.0 / FARTHEST, FARTHEST)
    return replace(
        now,
        offset_dn=now.offset_dn + offset,
        slope=now.slope + slope,
        gain_dn_per_e=np.where(now.gain_dn_per_e > 0, moved, 0.0),
        read_variance_dn2=np.maximum(now.read_variance_dn2 + read, LEAST_READ_DN2),
    )


def _noise_step(now: Baseline, missed: Change, evidence: Evidence) -> tuple[Floats, Floats]:
    """Return what each tap's gain, DN/e-, and read variance, DN^2, miss of the variances.

    Of blocks whose codes stop, as much of a step shows as the recording has of the noise of `now`.
    """
    sensor, first = evidence.sensor, evidence.baseline
    where = evidence.pooled.places["variance"]
    std, missing = evidence.pooled.std[:, where], missed.pooled[:, where]
    some = np.maximum(evidence.counts.pixels, 1.0)
    signal = np.stack([grouped(m - first.offset_dn, sensor) / some for m in first.mean_dn])
    hidden = own_means_hidden(first)[:, None]
    seen = evidence.pooled.observed[:, where]
    seen = seen + np.stack([mean.of["variance"] for mean, _ in evidence.pooled.expected])
    tap = np.arange(sensor.n_groups) // (sensor.n_groups // sensor.n_taps)
    gain, read = np.zeros(sensor.n_taps), np.zeros(sensor.n_taps)
    for t in range(sensor.n_taps):
        used = np.isfinite(std) & (std > 0) & (tap == t)
        if not used.any():
            continue
        noise = now.read_variance_dn2[t] + now.gain_dn_per_e[t] * np.maximum(signal, 0.0)
        shown = np.where(hidden, np.clip(seen / noise, 0.0, 1.0), 1.0)[used]
        design = np.stack([shown * signal[used], shown], axis=1)[
            :, [0, 1] if first.gain_dn_per_e[t] > 0 else [1]
        ]
        found = np.linalg.lstsq(design / std[used][:, None], missing[used] / std[used])[0]
        read[t] = found[-1]
        gain[t] = found[0] if len(found) > 1 else 0.0
    return gain, read
