"""One model fitted to one tap: its variances, and its means against exposure where they tell.

Weights come from the fitted model, never from the variances that they weigh: low variances and
high weights would go together. A variance has the variance a·V² + b·κ4 (a and b count the
differences, κ4 is Poisson's), and its overdispersion τ²V² on top; a mean V/n and the unrest of the
source η²s². All is fitted at once, weights anew until they stay.
"""

from dataclasses import dataclass
from enum import Enum

import numpy as np

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


@dataclass(frozen=True)
class _Data:
    """What is fitted, and the sizes that parameters have."""

    points: Points
    means: Means | None
    names: tuple[str, ...]

    @property
    def scale(self) -> Vector:
        """A typical size of every parameter."""
        top = max(float(np.nanmax(self.points.signal_dn)), 1.0)
        gain = max(float(np.median(self.points.variance_dn2)) / top, 1e-4)
        sizes = {
            "system_gain": gain,
            "read_variance_dn2": max(float(self.points.variance_dn2.min()), 0.1),
            "beta_per_dn": 0.1 / top,
            "a00_per_e": 0.1 * gain / top,
            "curvature": 0.1 * gain / top,
        }
        own = [sizes[n] for n in self.names]
        if self.means is None:
            return np.array(own)
        return np.array(own + self._responses() + [0.01 * float(self.means.exposure_us.max())])

    def _responses(self) -> list[float]:
        assert self.means is not None  # noqa: S101 - asked for only with means
        m = self.means
        return [
            float(np.mean(m.signal_dn[m.group == g] / m.exposure_us[m.group == g]))
            for g in range(m.n_groups)
        ]

    @property
    def start(self) -> Vector:
        """A straight line through the variances, and straight responses."""
        found = np.zeros(len(self.scale))
        v, s = self.points.variance_dn2, self.points.signal_dn
        weight = self.points.square_factor**-0.5 / np.maximum(v, 1e-3)
        design = np.stack([s, np.ones(len(s))], axis=1) * weight[:, None]
        found[:2] = np.linalg.lstsq(design, (v - 1.0 / 12.0) * weight, rcond=None)[0]
        found[0] = max(found[0], 1e-3 * self.scale[0])
        if self.means is not None:
            found[len(self.names) : -1] = self._responses()
        return found

    def shape(self, parameters: Vector) -> Shape:
        """Return the curve."""
        return Shape(**dict(zip(self.names, map(float, parameters), strict=False)))

    def variance_errors(self, shape: Shape) -> tuple[Vector, Vector, Vector]:
        """Return residuals of the variances, their variances by statistics, and V²."""
        p = self.points
        expected = shape.variance(p.signal_dn)
        own = p.square_factor * expected**2
        own += p.cumulant_factor * shape.fourth_cumulant(p.signal_dn)
        return p.variance_dn2 - expected, own, expected**2

    def mean_errors(self, parameters: Vector) -> tuple[Vector, Vector, Vector]:
        """Return residuals of the means, their variances by statistics, and s²; none without."""
        m = self.means
        if m is None:
            return np.empty(0), np.empty(0), np.empty(0)
        shape = self.shape(parameters)
        rate, offset = parameters[len(self.names) : -1], parameters[-1]
        linear = rate[m.group] * (m.exposure_us + offset)
        expected = shape.mean(linear, m.spread)
        own = shape.variance(expected) / m.samples
        return m.signal_dn - expected, own, expected**2


def fit_curve(points: Points, means: Means | None, model: Model) -> CurveFit:
    """Fit `model` to a tap's points, and to its means where there are any."""
    data = _Data(points, means, ("system_gain", "read_variance_dn2", *model.value))
    at, scale = data.start, data.scale
    tau2, eta2 = np.zeros(len(points)), 0.0
    for _ in range(_ROUNDS):
        _, own_v, size_v = data.variance_errors(data.shape(at))
        _, own_m, size_m = data.mean_errors(at)
        spread = np.sqrt(np.concatenate([own_v + tau2 * size_v, own_m + eta2 * size_m]))

        def residual(p: Vector, spread: Vector = spread) -> Vector:
            seen = (data.variance_errors(data.shape(p))[0], data.mean_errors(p)[0])
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


def _excesses(data: _Data, at: Vector, model: Model) -> tuple[ByLight, Excess | None]:
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
    data: _Data, model: Model, solution: Solution, by_variance: ByLight, by_mean: Excess | None
) -> CurveFit:
    at, n_curve = solution.parameters, len(data.names)
    shape = data.shape(at)
    errors = data.variance_errors(shape)
    has_means, dark = data.means is not None, data.points.is_dark
    size = np.sqrt(errors[2])
    return CurveFit(
        model=model,
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
