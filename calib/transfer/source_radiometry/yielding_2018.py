"""The experiment of Yielding, Cain and Seal (2018), section 4: an LED555L before a pinhole.

Source: Opt. Eng. 57 (2018) 014107, Tables 1 to 3. What the tables print is kept apart from what
their inputs give: see docs/photon-transfer/source-radiometry.md for where the two differ.
"""

from calib.transfer.source_radiometry.bounded import Bounded
from calib.transfer.source_radiometry.diverging_source import DivergingSource

LED555L = DivergingSource(
    power_w=Bounded(1.0e-3, 0.95e-3, 1.05e-3, "W"),
    wavelength_nm=Bounded(555.0, 545.0, 565.0, "nm"),
    half_angle_deg=Bounded.exact(20.0, "deg"),
    peak_over_mean=Bounded(2.0, 1.96, 2.041, "1"),
    distance_m=Bounded(4.33, 4.325, 4.335, "m"),
    aperture_radius_m=Bounded.exact(100e-6, "m"),
    exposure_s=Bounded(0.1, 0.0999, 0.1001, "s"),
)
"""Tables 1 and 3; no bounds are printed for the viewing angle and the pinhole."""

PRINTED_THEORETICAL = 2.2406e6
PRINTED_LOWER_BOUND = 2.4745e6
"""The larger of the two: the table swaps its bounds' labels."""
PRINTED_UPPER_BOUND = 2.0234e6
PRINTED_SANUC = 2.1844e6
PRINTED_ABSOLUTE_ERROR = 0.027
"""All of Table 2."""
