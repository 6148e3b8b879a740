"""Pixels that do not do what the others do: dead, hot, blinking."""

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from calib.mtf.assembly.saturation import saturated_pixels
from calib.mtf.harmonic_sums import Frames

_TIMES_MEDIAN = 8.0  # 5.4 standard deviations of a Gaussian scatter
_FAR = 20.0  # medians: the brightest pixels of a sparse pattern stay within
_BY_CHANCE = 1e-9
_SHOT_NOISE = 4.0  # the brightest pixels' variance may be so many times the median's
_ROUND_OFF = 1e-9


def plausible_pixels(images: Frames) -> NDArray[np.bool_]:
    """Return which pixels' means are not far beyond the others', before anything is fitted.

    Those that were saturated in some frames are not plausible, either.
    """
    mean = images.mean(axis=0)
    away = np.abs(mean - np.median(mean))
    good: NDArray[np.bool_] = away <= _FAR * np.median(away) + _ROUND_OFF * np.abs(mean).max()
    return good & ~saturated_pixels(images)


def good_pixels(residual: Frames, model: Frames) -> NDArray[np.bool_]:
    """Return which pixels follow the model as well as nearly all do, (n_rows, n_columns).

    A pixel is odd where its residual as a whole (its gain and offset included) stands far above the
    median, or where the part that no gain and offset explains does.
    """
    floor = (_ROUND_OFF * np.abs(model).mean()) ** 2
    power = (residual * residual).mean(0)
    light = (model * model).mean(0)
    brighter = np.maximum(light / np.median(light), 1)  # gain scatter grows with a pixel's light
    good: NDArray[np.bool_] = power <= _TIMES_MEDIAN**2 * brighter * np.median(power) + floor
    dof = len(residual) - 2
    if dof < 2:
        return good
    ripple = _unexplained(residual, model)
    bound = _SHOT_NOISE * float(chi2.isf(_BY_CHANCE, dof)) / float(chi2.median(dof))
    good &= ripple <= bound * np.median(ripple) + floor * len(residual)
    return good


def _unexplained(residual: Frames, model: Frames) -> NDArray[np.floating]:
    """Return the residual's power beside a straight line against the model, pixel by pixel."""
    centred, shape = residual - residual.mean(0), model - model.mean(0)
    slope = (centred * shape).sum(0) / np.maximum((shape * shape).sum(0), 1e-300)
    rest: NDArray[np.floating] = ((centred - slope * shape) ** 2).sum(0)
    return rest
