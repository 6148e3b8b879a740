"""Fits and covariances as JSON has them."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from calib.transfer.photon_transfer.astier import AstierFit
from calib.transfer.photon_transfer.curve_fit import CurveFit
from calib.transfer.photon_transfer.neighbours import Neighbours


def number(value: float) -> float | None:
    """Return a number, None where it is not known."""
    return float(value) if math.isfinite(value) else None


def model_answer(fit: CurveFit) -> dict[str, Any]:
    """Return a model's parameters and how likely the data are under it."""
    told: dict[str, Any] = {
        name: {"value": getattr(fit.shape, name), "std": number(fit.std(name))}
        for name in fit.names
    }
    mean = fit.mean_excess
    return {
        **told,
        "deviance": number(fit.deviance),
        "aicc": number(fit.aicc),
        "parameters": fit.n_parameters,
        "overdispersion_of_flats": fit.variance_excess.flats.relative,
        "overdispersion_of_darks": fit.variance_excess.darks.relative,
        "unrest_of_means": None if mean is None else mean.relative,
    }


def series_answer(fit: AstierFit) -> dict[str, Any]:
    """Return the brighter-fatter series' figures, by rows and columns of the lag."""

    def rows(kernel: NDArray[np.float64]) -> list[list[float | None]]:
        return [[number(v) for v in row] for row in kernel.tolist()]

    return {
        "system_gain_dn_per_e": {"value": fit.system_gain, "std": number(fit.system_gain_std)},
        "a_per_e": rows(fit.a_per_e),
        "a_per_e_std": rows(fit.a_std),
        "b_per_e": rows(fit.b_per_e),
        "chi_squared": number(fit.chi_squared),
        "freedom": fit.freedom,
    }


def neighbour_answer(found: Neighbours) -> dict[str, Any]:
    """Return how the pixels at one lag correlate."""
    return {
        "lag_rows_columns": list(found.lag),
        "correlation": {
            "value": number(found.correlation), "std": number(found.correlation_std)
        },
        "growth_per_e": {"value": number(found.growth_per_e), "std": number(found.growth_std)},
    }  # fmt: skip
