"""What the model knows and calibration has to find."""

from dataclasses import dataclass

from calib.arrays import Pixels


@dataclass(frozen=True)
class Truth:
    """The coefficients of DN = L VE QE t + DN0, each of a sample's shape, and the noise.

    That is (n_columns,), of an area sensor (n_rows, n_columns).

    Links outside that equation (drifts, nonlinearity, tones) are not in it. Neither is dark
    current: it adds `dark_signal_dn_per_us` x t. In a sweep of the exposure at one level that is
    a part of the slope, L VE QE + dark signal; in a sweep of the level at one exposure it is a
    part of the intercept, DN0 + dark signal x t.

    Attributes:
        dark_offset_dn: DN0 with the camera's black level, not clipped at 0.
        vignette: VE, the smooth optical profile, 1 at the axis.
        responsivity: QE, DN per radiance per us, PRNU and the taps' gains included.
        axis_column: From 0.
        system_gain_dn_per_e: K, the mean over the pixels.
        read_noise_e: Standard deviation, rounding left aside.
        dark_signal_dn_per_us: Of `dark_current`, and `dark_current_temperature` at its reference.
    """

    dark_offset_dn: Pixels
    vignette: Pixels
    responsivity: Pixels
    axis_column: float
    system_gain_dn_per_e: float
    read_noise_e: float
    dark_signal_dn_per_us: Pixels
