"""One model fitted to one tap: its variances, and its means against exposure where they tell.

Weights come from the fitted model, never from the variances that they weigh: low variances and
high weights would go together. A variance has the variance a·V² + b·κ4 (a and b count the
differences, κ4 is Poisson's), and its overdispersion τ²V² on top; a mean V/n and the unrest of the
source η²s². All is fitted at once, weights anew until they stay.
"""

from dataclasses import dataclass
from enum import Enum
from functools import lru_cache

import numpy as np

from calib.transfer.photon_transfer.curve_data import CurveData
from calib.transfer.photon_transfer.gauss_newton import Matrix, Solution, Vector, solve
from calib.transfer.photon_transfer.means import Means
from calib.transfer.photon_transfer.overdispersion import (
    ByLight,
    Excess,
    deviance,
    excess,
    excess_by_light,
)
from calib.transfer.photon_transfer.points import Points
from calib.transfer.photon_transfer.variance_curve import Shape

_ROUNDS = 5


class Model(Enum):
    """Which of a curve's parameters are free, besides K and σ_r²."""

    STRAIGHT = ()
    QUADRATIC = ("curvature",)
    NONLINEAR = ("beta_per_dn",)
    BRIGHTER_FATTER = ("a00_per_e",)
    NONLINEAR_AND_BRIGHTER_FATTER = ("beta_per_dn", "a00_per_e")

    @property
    def label(self) -> str:
        """As it stands in answers."""
        return self.name.lower()


@dataclass(frozen=True)
class CurveFit:
    """A model's fit to a tap.

    Attributes:
        model: Which.
        data: What it was fitted to.
        solution: Of all parameters, those of the response included.
        shape: The curve.
        names: Of the curve's free parameters, as in `Shape`.
        covariance: Of these, in their order.
        variance_excess: Overdispersion τ of the variances, of flats and of darks.
        mean_excess: Unrest η of the means; None where means were not fitted.
        deviance_variances: −2 ln L of the variances.
        deviance_means: −2 ln L of the means; 0 where there are none.
        n_parameters: All that were fitted, τ and η included.
        n_data: Variances and means.
        residual: Of the variances, relative to the model, (n_points,).
        sigma: Their standard uncertainty by statistics, relative, (n_points,).
        exposure_offset_us: δ; NaN without means.
    """

    model: Model
    data: CurveData
    solution: Solution
    shape: Shape
    names: tuple[str, ...]
    covariance: Matrix
    variance_excess: ByLight
    mean_excess: Excess | None
    deviance_variances: float
    deviance_means: float
    n_parameters: int
    n_data: int
    residual: Vector
    sigma: Vector
    exposure_offset_us: float

    @property
    def deviance(self) -> float:
        """−2 ln L of all data."""
        return self.deviance_variances + self.deviance_means

    @property
    def aicc(self) -> float:
        """Akaike's criterion, corrected for few data (Hurvich and Tsai 1989)."""
        k, n = self.n_parameters, self.n_data
        return self.deviance + 2.0 * k + (2.0 * k * (k + 1) / (n - k - 1) if n > k + 1 else np.inf)

    def std(self, name: str) -> float:
        """Return the standard uncertainty of a parameter of the curve; 0 where it is fixed."""
        if name not in self.names:
            return 0.0
        k = self.names.index(name)
        return float(np.sqrt(self.covariance[k, k]))


def fit_curve(points: Points, means: Means | None, model: Model) -> CurveFit:
    """Fit `model` to a tap's points, and to its means where there are any."""
    data = CurveData(points, means, ("system_gain", "read_variance_dn2", *model.value))
    at, scale = data.start, data.scale
    # Most parameters are levels' responses, which leave the curve as it is.
    of_variances = lru_cache(maxsize=16)(data.variance_residuals)
    tau2, eta2 = np.zeros(len(points)), 0.0
    for _ in range(_ROUNDS):
        _, own_v, size_v = data.variance_errors(data.shape(at))
        _, own_m, size_m = data.mean_errors(at)
        spread = np.sqrt(np.concatenate([own_v + tau2 * size_v, own_m + eta2 * size_m]))

        def residual(p: Vector, spread: Vector = spread) -> Vector:
            seen = of_variances(data.shape(p)), data.mean_residuals(p)
            return np.asarray(np.concatenate(seen) / spread)

        solution = solve(residual, at, scale)
        stays = np.all(np.abs(solution.parameters - at) < 1e-6 * scale)
        at = solution.parameters
        by_variance, by_mean = _excesses(data, at, model)
        tau2 = by_variance.tau2(points.is_dark)
        eta2 = by_mean.relative**2 if by_mean is not None else 0.0
        if stays:
            break
    return _result(data, model, solution, by_variance, by_mean)


def _excesses(data: CurveData, at: Vector, model: Model) -> tuple[ByLight, Excess | None]:
    """Return τ and η; β counts against the means where there are any."""
    bend_in_means = data.means is not None and "beta_per_dn" in model.value
    n_curve = len(data.names) - bend_in_means
    errors = data.variance_errors(data.shape(at))
    by_variance = excess_by_light(*errors, data.points.is_dark, n_curve)
    if data.means is None:
        return by_variance, None
    left = len(data.means) - data.means.n_groups - 1 - bend_in_means
    return by_variance, excess(*data.mean_errors(at), freedom=left, least_likely=1.0)


def _result(
    data: CurveData, model: Model, solution: Solution, by_variance: ByLight, by_mean: Excess | None
) -> CurveFit:
    at, n_curve = solution.parameters, len(data.names)
    shape = data.shape(at)
    errors = data.variance_errors(shape)
    has_means, dark = data.means is not None, data.points.is_dark
    size = np.sqrt(errors[2])
    return CurveFit(
        model=model,
        data=data,
        solution=solution,
        shape=shape,
        names=data.names,
        covariance=solution.covariance[:n_curve, :n_curve],
        variance_excess=by_variance,
        mean_excess=by_mean,
        deviance_variances=sum(
            deviance(*(part[which] for part in errors)) for which in (dark, ~dark)
        ),
        deviance_means=deviance(*data.mean_errors(at)) if has_means else 0.0,
        n_parameters=len(at) + 1 + bool(dark.any()) + has_means,
        n_data=len(errors[0]) + (len(data.means) if data.means is not None else 0),
        residual=errors[0] / size,
        sigma=np.sqrt(errors[1]) / size,
        exposure_offset_us=float(at[-1]) if has_means else float("nan"),
    )
