"""Photon-transfer noise: how the temporal variance grows with the signal.

    σ²(s) = K·s + σ_r²,    s = mean − DN0,    DN², before rounding

K is the system gain (DN per electron), σ_r the read noise in DN; Poisson light makes the first
term. Rounding adds 1/12 and, for σ below about 0.5 DN, the terms of `rounding`. One line is fitted
to all columns together: a column's own variance is too noisy for a weight, and a weight that is
made from the data it weighs biases the mean (low variances and low signals go together).

Source: EMVA Standard 1288, Release 4.0 Linear, section 2; Janesick, Photon Transfer (2007).
"""

from dataclasses import dataclass

import numpy as np

from calib.arrays import Columns
from calib.errors import NotDeterminedError
from calib.radiometric.estimation.block_table import Cells, Mask
from calib.radiometric.estimation.rounding import (
    INVERTIBLE_SIGMA_DN,
    rounded_moments,
    typical_variance,
    unrounded_mean,
)


@dataclass(frozen=True)
class NoiseModel:
    """One photon-transfer line for the whole sensor.

    Attributes:
        system_gain_dn_per_e: K, DN per electron; 0 where no shot noise is seen.
        read_variance_dn2: σ_r², DN².
        system_gain_dn_per_e_std: Standard uncertainty of K.
        read_variance_dn2_std: Standard uncertainty of σ_r².
    """

    system_gain_dn_per_e: float
    read_variance_dn2: float
    system_gain_dn_per_e_std: float
    read_variance_dn2_std: float

    def sigma_dn(self, signal_dn: Cells) -> Cells:
        """Return the noise before rounding, DN, of a signal above DN0."""
        shot = self.system_gain_dn_per_e * np.maximum(signal_dn, 0.0)
        return np.sqrt(shot + self.read_variance_dn2)

    def is_near(self, other: "NoiseModel") -> bool:
        """Return whether weights from both are the same to 1e-3, far below what they matter."""
        gains = self.system_gain_dn_per_e, other.system_gain_dn_per_e
        floors = self.read_variance_dn2, other.read_variance_dn2
        return bool(np.isclose(*gains, rtol=1e-3) and np.isclose(*floors, rtol=1e-3, atol=1e-4))

    @property
    def read_noise_e(self) -> float:
        """σ_r in electrons; NaN where K is not seen."""
        if self.system_gain_dn_per_e <= 0:
            return float("nan")
        return float(np.sqrt(self.read_variance_dn2) / self.system_gain_dn_per_e)

    @property
    def read_noise_e_std(self) -> float:
        """Standard uncertainty of `read_noise_e`, by propagation from σ_r² and K.

        Their covariance is left out: it is negative, so that this is on the large side.
        """
        if self.system_gain_dn_per_e <= 0 or self.read_variance_dn2 <= 0:
            return float("nan")
        relative = np.hypot(
            0.5 * self.read_variance_dn2_std / self.read_variance_dn2,
            self.system_gain_dn_per_e_std / self.system_gain_dn_per_e,
        )
        return float(self.read_noise_e * relative)


def fit_noise_model(
    mean_dn: Cells,
    variance_dn2: Cells,
    n_lines: Columns,
    offset_dn: Columns,
    use: Mask,
    *,
    start: NoiseModel | None = None,
) -> NoiseModel:
    """Fit K and σ_r² to the cells in `use` by weighted least squares.

    The weight of a variance from n lines is (n − 1) / 2V², V from the fit before (starting from
    the pooled variance), and rounding's part is taken off by the fit before.

    Args:
        mean_dn: Mean codes, (n_blocks, n_columns).
        variance_dn2: Temporal variances of the codes.
        n_lines: Lines of each block, (n_blocks,).
        offset_dn: DN0, (n_columns,).
        use: Cells that are neither clipped nor masked.
        start: A fit to nearly the same cells, from which few steps lead on.

    Raises:
        NotDeterminedError: `no-temporal-noise` where no block has two lines or more.
    """
    use = use & np.isfinite(variance_dn2) & np.isfinite(offset_dn)
    if not use.any():
        message = (
            "No unclipped block has two lines or more, so that the noise and with it the weights "
            "are not determined: record blocks of many lines, and less light."
        )
        raise NotDeterminedError(message, code="no-temporal-noise")
    mean, observed = mean_dn[use], variance_dn2[use]
    signal = np.maximum((mean_dn - offset_dn)[use], 0.0)
    freedom = np.broadcast_to(n_lines[:, None], mean_dn.shape)[use] - 1.0
    pooled = NoiseModel(0.0, max(float(observed.mean()) - 1.0 / 12.0, 1e-4), 0.0, 0.0)
    model = start or pooled
    for _ in range(2 if start else 6):
        sigma = model.sigma_dn(signal)
        codes = rounded_moments(unrounded_mean(mean, sigma).mean_dn, sigma)
        typical = typical_variance(sigma)
        expected = np.where(sigma < INVERTIBLE_SIGMA_DN, typical, codes.variance_dn2)
        model = _line(signal, observed - (expected - sigma**2), freedom, typical)
    return model


def _line(signal: Columns, variance: Columns, freedom: Columns, expected: Columns) -> NoiseModel:
    """Fit variance = K·signal + σ_r², both not negative."""
    weight = freedom / (2.0 * expected**2)
    total, first = weight.sum(), (weight * signal).sum()
    centre = first / total
    spread = (weight * (signal - centre) ** 2).sum()
    level = (weight * variance).sum() / total
    if spread > 0:
        gain = max(float((weight * (signal - centre) * variance).sum() / spread), 0.0)
    else:
        gain = 0.0
    floor = level - gain * centre
    if floor < 0:
        floor, gain = 0.0, float(max((weight * signal * variance).sum(), 0.0))
        gain /= float((weight * signal**2).sum())
    misfit = weight * (variance - gain * signal - floor) ** 2
    inflate = max(1.0, float(misfit.sum()) / max(len(signal) - 2, 1))
    gain_std = np.sqrt(inflate / spread) if spread > 0 else float("nan")
    floor_std = np.sqrt(inflate * (1.0 / total + (centre**2 / spread if spread > 0 else 0.0)))
    return NoiseModel(gain, float(floor), float(gain_std), float(floor_std))
