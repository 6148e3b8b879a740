"""How much the points leave the straight lines by, beyond their noise."""

from dataclasses import replace

import numpy as np

from calib.transfer.emva1288.fits import DarkLine, Fits, misfit
from calib.transfer.emva1288.series import Series


def misfits(series: Series, fits: Fits) -> tuple[float, float]:
    """Return the relative uncertainties of K and R that their lines' lack of fit adds.

    Where χ²/ν says that noise alone does not explain the residuals, the slope's own uncertainty
    grows by its square root (Birge's ratio); returned is what has to be added in quadrature.
    """
    use = fits.transfer
    flats = [series.flats[k] for k in use]
    darks = [series.darks[series.dark_of[k]] for k in use]
    x = np.array([f.mean_dn - d.mean_dn for f, d in zip(flats, darks, strict=True)])
    y = np.array([f.variance_dn2 - d.variance_dn2 for f, d in zip(flats, darks, strict=True)])
    noise_x = np.array([np.hypot(f.mean_dn_std, d.mean_dn_std)
                        for f, d in zip(flats, darks, strict=True)])  # fmt: skip
    noise_y = np.array([np.hypot(f.variance_dn2_std, d.variance_dn2_std)
                        for f, d in zip(flats, darks, strict=True)])  # fmt: skip
    return _added(x, y, noise_y), _added(series.light[use], x, noise_x)


def _added(x: np.ndarray, y: np.ndarray, noise: np.ndarray) -> float:
    slope = float(np.sum(x * y) / np.sum(x**2))
    # The residuals of the weighted line have the χ² distribution; those of the standard's have not.
    weighted = float(np.sum(x * y / noise**2) / np.sum((x / noise) ** 2))
    birge = misfit(y - weighted * x, noise, len(x) - 1)
    own = float(np.sqrt(np.sum((x * noise) ** 2)) / np.sum(x**2))
    return own * float(np.sqrt(birge**2 - 1.0)) / abs(slope) if slope else 0.0


def with_unrest(series: Series, fits: Fits) -> tuple[Series, tuple[str, ...]]:
    """Return the series whose darks are as uncertain as their lines against exposure say.

    What moves a dark between blocks, an offset that drifts, moves the flats' darks as well.
    """
    darks, warnings = list(series.darks), []
    for what, lines in (("mean_dn", fits.means), ("variance_dn2", fits.variances)):
        for line in lines:
            ratio = _unrest(series, line, what)
            if ratio > 1.0:
                warnings.append(
                    f"the darks' {'means' if what == 'mean_dn' else 'variances'} leave a straight "
                    f"line against exposure by {ratio:.3g} times their noise: their uncertainties "
                    "are widened by that"
                )
            for k in line.darks:
                std = f"{what}_std"
                darks[k] = replace(darks[k], **{std: ratio * getattr(darks[k], std)})
    return replace(series, darks=tuple(darks)), tuple(warnings)


def _unrest(series: Series, line: DarkLine, what: str) -> float:
    darks = [series.darks[k] for k in line.darks]
    t_s = np.array([d.block.exposure_us for d in darks]) * 1e-6
    if len(line.slope) == 0 or len({round(each, 12) for each in t_s.tolist()}) < 3:
        return 1.0
    value = np.array([getattr(d, what) for d in darks])
    noise = np.array([getattr(d, f"{what}_std") for d in darks])
    left = value - line.intercept @ value - (line.slope @ value) * t_s
    return misfit(left, noise, len(darks) - 2)
