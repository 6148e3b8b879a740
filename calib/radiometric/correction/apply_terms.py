"""What a coefficient set says of each column at one exposure, in the form that the kernel takes.

Law of propagation (JCGM 100:2008, section 5) for L = s / (g·t·T) with s = DN - dark, g = VE·QE:

    u²(L) = [K·max(s, 0) + K·d·t + K²·r² + 1/12      temporal noise of this one sample
             + u²(DN0) + t²·u²(dark current)         the dark level
             + 2·(s/g)·cov(DN0, g) + (s/g)²·u²(g)    the slope, which errs together with DN0
             + s²·(u²(scale) + u²(T)) ] / (g·t·T)²   what all columns share, relative

K is the system gain in DN/e-, r the read noise in e-, 1/12 the rounding. The dark current's d·t is
made of electrons too, whose number scatters (EMVA Standard 1288, Release 4.0 Linear, Eq. 9); a d
that came out negative has none. The dark current's error
also hides in g, with the opposite sign: leaving that out overstates u, never the contrary.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.arrays import Columns
from calib.kernels.radiance import Terms
from calib.radiometric.coefficients.coefficient_set import CoefficientSet


@dataclass(frozen=True)
class ColumnTerms:
    """Per column (n_columns,), double precision; NaN scale where the column is masked.

    The variance of s is (noise + K·max(s, 0)) for the temporal part, of which each sample has its
    own error, and (v0 + v1·s + v2·s²) for the coefficients', which all samples of a column share.

    Attributes:
        dark_dn: DN0 and the dark current's signal, DN.
        scale: 1/(g·t·T), radiance per DN.
        v0: DN².
        v1: DN.
        v2: Dimensionless; the relative variance of scale, window and slope.
        common: The part of `v2` that all columns share.
        noise_dn2: Temporal variance without light, the dark current's shot noise included, DN².
        gain: System gain K, DN/e-.
        exposure_us: t.
    """

    dark_dn: Columns
    scale: Columns
    v0: Columns
    v1: Columns
    v2: Columns
    common: float
    noise_dn2: Columns
    gain: float
    exposure_us: float

    def in_single_precision(self) -> Terms:
        """Return dark, scale, c0, c1, c2 and K as the kernel takes them."""
        return (
            self.dark_dn.astype(np.float32),
            self.scale.astype(np.float32),
            (self.v0 + self.noise_dn2).astype(np.float32),
            self.v1.astype(np.float32),
            self.v2.astype(np.float32),
            np.float32(self.gain),
        )

    def temporal_variance_dn2(self, signal_dn: NDArray[np.floating]) -> Columns:
        """Return the temporal variance of one sample of the given signal, DN²."""
        variance = self.noise_dn2 + self.gain * np.maximum(signal_dn, 0.0)
        return np.asarray(variance, dtype=np.float64)

    def coefficient_variance_dn2(self, signal_dn: NDArray[np.floating]) -> Columns:
        """Return the variance that the coefficients bring into a signal, DN²."""
        variance = self.v0 + signal_dn * (self.v1 + self.v2 * signal_dn)
        return np.asarray(variance, dtype=np.float64)


def column_terms(
    coefficients: CoefficientSet,
    exposure_us: float,
    window_relative_std: float,
    transmittance: float,
) -> ColumnTerms:
    """Return the terms of `coefficients` at one exposure, behind a window."""
    slope = np.where(coefficients.valid, coefficients.slope, np.nan)
    dark_current_std = coefficients.dark_current_dn_per_us_std * exposure_us
    common = coefficients.scale_relative_std**2 + window_relative_std**2
    gain = coefficients.system_gain_dn_per_e
    dark_signal = np.maximum(np.nan_to_num(coefficients.dark_current_dn_per_us), 0.0) * exposure_us
    return ColumnTerms(
        dark_dn=coefficients.dark_level_dn(exposure_us),
        scale=1.0 / (slope * exposure_us * transmittance),
        v0=coefficients.dark_offset_dn_std**2 + dark_current_std**2,
        v1=2.0 * coefficients.offset_slope_covariance / slope,
        v2=(coefficients.slope_std / slope) ** 2 + common,
        common=common,
        noise_dn2=gain * dark_signal + (gain * coefficients.read_noise_e) ** 2 + 1.0 / 12.0,
        gain=gain,
        exposure_us=exposure_us,
    )
