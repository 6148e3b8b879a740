"""The points that the temporal figures were read from."""

import math

import numpy as np

from calib.transfer.emva1288.formulas import Formulas, relative_line
from calib.transfer.emva1288.series import Series
from calib.transfer.emva1288.sheet import DarkCurve, TransferCurve
from calib.transfer.estimate import Estimate

_AT = "dark_current_e_per_s at "
Found = dict[str, tuple[float, float]]


def transfer_curve(formulas: Formulas, found: Found) -> TransferCurve:
    """Return the flats as the standard draws them."""
    series, fits = formulas.series, formulas.fits
    darks = [series.darks[k] for k in series.dark_of]
    pairs = list(zip(series.flats, darks, strict=True))
    signal = np.array([f.mean_dn - d.mean_dn for f, d in pairs])
    deviation = np.full((2, len(pairs)), np.nan)
    for index in fits.linearity:
        deviation[:, index] = found.get(f"deviation_percent {index}", (math.nan, math.nan))
    line = (math.nan, math.nan)
    if len(fits.linearity) > 1:
        offset, slope = relative_line(series.light[fits.linearity], signal[fits.linearity])
        line = (float(offset), float(slope))
    rate = formulas.photons_per_light
    return TransferCurve(
        light=series.light,
        photons=None if rate is None else rate * series.light,
        signal_dn=signal,
        signal_std=np.array([math.hypot(f.mean_dn_std, d.mean_dn_std) for f, d in pairs]),
        variance_dn2=np.array([f.variance_dn2 - d.variance_dn2 for f, d in pairs]),
        variance_std=np.array(
            [math.hypot(f.variance_dn2_std, d.variance_dn2_std) for f, d in pairs]
        ),
        noise_dn=np.sqrt([f.variance_dn2 for f, _ in pairs]),
        share_at_full_scale=np.array([f.share_at_full_scale for f, _ in pairs]),
        in_transfer=np.isin(np.arange(len(pairs)), fits.transfer),
        deviation_percent=deviation[0],
        deviation_std=deviation[1],
        line=line,
    )


def dark_curve(series: Series, found: Found) -> DarkCurve:
    """Return the darks, and the current at each temperature."""
    darks = series.darks
    known = [d.block.sensor_temperature_c for d in darks]
    currents = {
        float(name.removeprefix(_AT)): Estimate(*moments, "e-/s")
        for name, moments in found.items()
        if name.startswith(_AT)
    }
    return DarkCurve(
        exposure_us=np.array([d.block.exposure_us for d in darks]),
        temperature_c=np.array([math.nan if each is None else each for each in known]),
        mean_dn=np.array([d.mean_dn for d in darks]),
        mean_std=np.array([d.mean_dn_std for d in darks]),
        variance_dn2=np.array([d.variance_dn2 for d in darks]),
        variance_std=np.array([d.variance_dn2_std for d in darks]),
        currents_e_per_s={c: e for c, e in currents.items() if math.isfinite(c)},
    )
