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
from calib.kernels.noise_sums import NoiseSums, noise_sums
from calib.radiometric.estimation.block_table import Cells, Mask
from calib.rounding import INVERTIBLE_SIGMA_DN, NEGLIGIBLE_SIGMA_DN

STEPS = 20
SETTLED_SHARE = 1e-4
"""A line that moves by less of its standard uncertainties stands still: a step leaves a hundredth
of the way or less."""


@dataclass(frozen=True)
class NoiseModel:
    """One photon-transfer line for the whole sensor.

    Attributes:
        system_gain_dn_per_e: K, DN per electron; 0 where no shot noise is seen.
        read_variance_dn2: σ_r², DN².
        system_gain_dn_per_e_std: Standard uncertainty of K.
        read_variance_dn2_std: Standard uncertainty of σ_r².
        covariance: Of K and σ_r²; negative, since the line turns about its middle.
    """

    system_gain_dn_per_e: float
    read_variance_dn2: float
    system_gain_dn_per_e_std: float
    read_variance_dn2_std: float
    covariance: float = 0.0

    def sigma_dn(self, signal_dn: Cells) -> Cells:
        """Return the noise before rounding, DN, of a signal above DN0."""
        shot = self.system_gain_dn_per_e * np.maximum(signal_dn, 0.0)
        return np.sqrt(shot + self.read_variance_dn2)

    def is_near(self, other: "NoiseModel", share: float) -> bool:
        """Return whether both lines differ by at most `share` of their standard uncertainties."""
        gain = abs(self.system_gain_dn_per_e - other.system_gain_dn_per_e)
        floor = abs(self.read_variance_dn2 - other.read_variance_dn2)
        # One signal only leaves the gain 0 and its uncertainty unknown.
        far = gain > share * self.system_gain_dn_per_e_std
        return not (far or floor > share * self.read_variance_dn2_std)

    @property
    def read_noise_e(self) -> float:
        """σ_r in electrons; NaN where K is not seen."""
        if self.system_gain_dn_per_e <= 0:
            return float("nan")
        return float(np.sqrt(self.read_variance_dn2) / self.system_gain_dn_per_e)

    @property
    def read_noise_e_std(self) -> float:
        """Standard uncertainty of `read_noise_e`, relative that of ln σ_r² / 2 − ln K.

        Both terms err with opposite signs, so that their covariance adds to it.
        """
        if self.system_gain_dn_per_e <= 0 or self.read_variance_dn2 <= 0:
            return float("nan")
        by_floor = 0.5 * self.read_variance_dn2_std / self.read_variance_dn2
        by_gain = self.system_gain_dn_per_e_std / self.system_gain_dn_per_e
        across = self.covariance / (self.read_variance_dn2 * self.system_gain_dn_per_e)
        return float(self.read_noise_e * np.sqrt(by_floor**2 + by_gain**2 - across))


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

    The weight of a variance from n lines is (n − 1) / 2V², V from the step before (starting from
    the pooled variance). The codes' variance is not that before rounding; its derivative to σ²,
    averaged over the phases of the mean, makes Newton's steps of what is left over.

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
    chosen = np.flatnonzero(use)
    signal = np.maximum(mean_dn - offset_dn, 0.0).take(chosen)
    freedom = np.repeat(n_lines - 1.0, use.sum(axis=1))
    cells = signal, mean_dn.take(chosen), variance_dn2.take(chosen), freedom
    model = start or NoiseModel(0.0, max(float(cells[2].mean()) - 1.0 / 12.0, 1e-4), 0.0, 0.0)
    restored = cells[1].copy()
    for _ in range(STEPS):
        line = model.system_gain_dn_per_e, model.read_variance_dn2
        sums = noise_sums(
            cells,
            restored,
            line,
            smallest_dn=INVERTIBLE_SIGMA_DN,
            negligible_dn=NEGLIGIBLE_SIGMA_DN,
        )
        last, model = model, _line(sums, len(signal))
        if model.is_near(last, SETTLED_SHARE):
            break
    return model


def _line(sums: NoiseSums, n_cells: int) -> NoiseModel:
    """Return the line variance = K·signal + σ_r² that the sums make, both not negative."""
    centre, level = sums.hs / sums.h, sums.hy / sums.h
    spread = sums.hss - centre * sums.hs
    gain = max((sums.hsy - centre * sums.hy) / spread, 0.0) if spread > 0 else 0.0
    floor = level - gain * centre
    if floor < 0:
        floor, gain = 0.0, max(sums.hsy, 0.0) / sums.hss
    centre = sums.ws / sums.w
    spread = sums.wss - centre * sums.ws
    inflate = max(1.0, sums.misfit / max(n_cells - 2, 1))
    gain_std = np.sqrt(inflate / spread) if spread > 0 else float("nan")
    floor_std = np.sqrt(inflate * (1.0 / sums.w + (centre**2 / spread if spread > 0 else 0.0)))
    covariance = -centre * inflate / spread if spread > 0 else 0.0
    return NoiseModel(gain, floor, float(gain_std), float(floor_std), float(covariance))
