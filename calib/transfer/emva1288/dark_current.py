"""Dark current, from the darks' means and from their variances, and how it grows when warm.

Source: EMVA Standard 1288, Release 4.0 Linear, section 7: µ_y.dark = µ_0 + µ_I.y t (Eq. 29) and
σ²_y.dark = σ²_0 + K µ_I.y t (Eq. 30), each a straight line against the exposure.
"""

from collections.abc import Iterator

import numpy as np

from calib.transfer.emva1288.fits import Fits
from calib.transfer.emva1288.inputs import Measured
from calib.transfer.emva1288.propagation import Batch
from calib.transfer.emva1288.series import Series, temperature_of


def dark_currents(
    series: Series, fits: Fits, measured: Measured, gain: Batch
) -> Iterator[tuple[str, Batch]]:
    """Yield the currents at the flats' temperature, each temperature's, and their doubling."""
    own = fits.means[series.own_temperature]
    if len(own.slope):
        by_mean = measured.dark_mean[..., list(own.darks)] @ own.slope
        line = fits.variances[series.own_temperature]
        by_variance = measured.dark_variance[..., list(line.darks)] @ line.slope
        yield "dark_current_mean_dn_per_s", by_mean
        yield "dark_current_mean_e_per_s", by_mean / gain
        yield "dark_current_variance_dn_per_s", by_variance / gain
        yield "dark_current_variance_e_per_s", by_variance / gain**2
    lines = [line for line in fits.means if len(line.slope)]
    at_c = [temperature_of(line.darks, series.darks) for line in lines]
    currents = [measured.dark_mean[..., list(line.darks)] @ line.slope / gain for line in lines]
    for celsius, current in zip(at_c, currents, strict=True):
        yield f"dark_current_e_per_s at {celsius}", current
    if len(currents) > 1:
        yield "dark_current_doubling_c", doubling(np.array(at_c), np.stack(currents, axis=-1))


def doubling(at_c: Batch, currents: Batch) -> Batch:
    """Return the °C in which currents double: 1 over the slope of their log₂, (…, n) by (n,)."""
    off = at_c - np.mean(at_c)
    found: Batch = np.sum(off**2) / np.sum(off * np.log2(currents), axis=-1)
    return found
