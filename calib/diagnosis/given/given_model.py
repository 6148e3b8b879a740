"""A model that somebody believes in, against what was fitted: which of its numbers differ."""

import numpy as np

from calib.arrays import Columns
from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.given.parameter_off import ParameterOff
from calib.forward.model import Model

DIFFERS_SIGMA = 4.0
"""A number that is so far off is no chance; five or six are compared."""


def parameters_off(given: Model, evidence: Evidence) -> tuple[ParameterOff, ...]:
    """Return the parameters of `given` that the recording contradicts."""
    compared = (*_of_noise(given, evidence), *_of_lines(given, evidence))
    return tuple(p for p in compared if abs(p.fitted - p.model) > DIFFERS_SIGMA * p.std)


def _of_noise(given: Model, evidence: Evidence) -> tuple[ParameterOff, ...]:
    """Return what variances tell: the system gain, and the read noise."""
    truth, base = given.truth(), evidence.baseline
    gain, read = base.gain_dn_per_e, base.read_variance_dn2
    gain_std, read_std = noise_std(evidence)
    read_e = np.sqrt(np.maximum(read - 1.0 / 12.0, 0.0)) / np.maximum(gain, 1e-12)
    read_e_std = 0.5 * read_std / np.maximum(np.sqrt(np.maximum(read - 1 / 12, 0.01)) * gain, 1e-12)
    return (
        ParameterOff(
            "system_gain.dn_per_e", truth.system_gain_dn_per_e, float(gain.mean()),
            _std_of_mean(gain_std), "DN/e-",
        ),
        ParameterOff(
            "read_noise.std_e", truth.read_noise_e, float(read_e.mean()),
            _std_of_mean(read_e_std), "e-",
        ),
    )  # fmt: skip


def _of_lines(given: Model, evidence: Evidence) -> tuple[ParameterOff, ...]:
    """Return what pixels' means over their dose tell: the offset, and the responsivity."""
    truth, base = given.truth(), evidence.baseline
    gain, (gain_std, _) = max(float(base.gain_dn_per_e.mean()), 1e-12), noise_std(evidence)
    offset_std, slope_std = line_std(evidence)
    shape = base.offset_dn.shape
    offset = (base.offset_dn - truth.dark_offset_dn.reshape(shape)).mean()
    response = truth.responsivity.reshape(shape) * truth.vignette.reshape(shape)
    ratio = base.slope.mean() / response.mean()
    scale = _scale(given)
    return (
        ParameterOff(
            "offset.mean_dn", float(truth.dark_offset_dn.mean()),
            float(truth.dark_offset_dn.mean() + offset), offset_std, "DN",
        ),
        ParameterOff(
            "responsivity.electrons_per_radiance_us", scale,
            float(scale * ratio * truth.system_gain_dn_per_e / gain),
            float(scale * np.hypot(slope_std / response.mean(), _std_of_mean(gain_std) / gain)),
            "e-/(radiance us)",
        ),
    )  # fmt: skip


def _std_of_mean(std: Columns) -> float:
    """Return the standard uncertainty of the mean of independent numbers, one a tap."""
    return float(np.sqrt((std**2).mean() / len(std)))


def _scale(given: Model) -> float:
    response = given.effect("responsivity")
    return float(getattr(response, "electrons_per_radiance_us", 1.0))


def noise_std(evidence: Evidence) -> tuple[Columns, Columns]:
    """Return standard uncertainties of each tap's gain, DN/e-, and read variance, DN^2."""
    gains, reads = [], []
    signal = evidence.baseline.mean_dn - evidence.baseline.offset_dn
    for tap in range(evidence.sensor.n_taps):
        of_tap = evidence.sensor.tap == tap
        s = np.array([signal[b][of_tap].mean() for b in range(evidence.n_blocks)])
        v = np.array([evidence.baseline.variance_dn2[b][of_tap].mean() for b in range(len(s))])
        information = (evidence.n - 1) * of_tap.sum() / (2.0 * v**2)
        design = np.stack([s, np.ones_like(s)], axis=1)
        covariance = np.linalg.pinv((design * information[:, None]).T @ design)
        gains.append(float(np.sqrt(covariance[0, 0])))
        reads.append(float(np.sqrt(covariance[1, 1])))
    return np.array(gains), np.array(reads)


def line_std(evidence: Evidence) -> tuple[float, float]:
    """Return the standard uncertainties of the mean offset, DN, and of the mean slope."""
    weight2 = evidence.space.weight**2
    x = evidence.baseline.dose.reshape(weight2.shape)
    s0, s1, s2 = ((x**k * weight2).sum(axis=0) for k in (0, 1, 2))
    determinant = np.maximum(s0 * s2 - s1 * s1, 1e-300)
    fine = s0 > 0
    n = max(int(fine.sum()), 1)
    offset = float(np.sqrt((s2 / determinant)[fine].sum()) / n)
    slope = float(np.sqrt((s0 / determinant)[fine].sum()) / n)
    return offset, slope
