"""From inverted lines to radiance, its standard uncertainty and its flags: the kernel's twin."""

import numpy as np
from numpy.typing import NDArray

from calib.arrays import RawLines
from calib.kernels.radiance import Floats
from calib.radiometric.correction.apply_terms import ColumnTerms
from calib.radiometric.correction.flags import Flag
from calib.radiometric.correction.inversion import Inversion


def fill_inverted(
    codes: RawLines,
    inversion: Inversion,
    *,
    terms: ColumnTerms,
    limits_dn: tuple[int, int, int],
    base_flags: NDArray[np.uint8],
    out: tuple[Floats, Floats | None, NDArray[np.uint8]],
) -> None:
    """Fill `out` as `calib.kernels.radiance.correct` does, from codes without departures.

    The response's terms hold for those; their temporal variance is that of what was inverted.
    """
    lowest, highest, full_scale = limits_dn
    radiance, std, flags = out
    found = inversion.lines(codes)
    signal, dn = found.signal_dn, found.signal_dn + terms.dark_dn
    radiance[...] = signal * terms.scale
    saturated = (codes >= full_scale) | found.unreached
    if std is not None:
        temporal = terms.temporal_variance_dn2(signal) * inversion.noise_ratio(signal)
        deviation = np.sqrt(temporal + terms.coefficient_variance_dn2(signal)) * terms.scale
        std[...] = np.where(saturated & np.isfinite(deviation), np.inf, deviation)
    flags[...] = base_flags
    for where, flag in (
        (saturated, Flag.SATURATED),
        ((signal < 0.0) | (codes == 0), Flag.BELOW_BLACK),
        ((dn < lowest) | (dn > highest), Flag.EXTRAPOLATED),
    ):
        flags[where] |= np.uint8(flag)
