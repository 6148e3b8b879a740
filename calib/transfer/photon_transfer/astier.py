"""The brighter-fatter series (`charge_covariance`) fitted to variances and covariances of a tap."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from calib.arrays import Columns
from calib.transfer.photon_transfer.charge_covariance import Form, Kernel, covariance_model
from calib.transfer.photon_transfer.gauss_newton import Matrix, Solution, Vector, solve
from calib.transfer.photon_transfer.overdispersion import ByLight, excess_by_light
from calib.transfer.photon_transfer.points import Points
from calib.transfer.photon_transfer.variance_curve import ROUNDING_DN2, Shape, rounded_variance


@dataclass(frozen=True)
class AstierFit:
    """The series fitted to a tap.

    Attributes:
        form: Which terms.
        system_gain: K, DN per electron.
        system_gain_std: Its standard uncertainty.
        read_variance_dn2: n_00, DN², before rounding.
        read_variance_dn2_std: Its standard uncertainty.
        gain_read_covariance: Of the two.
        a_per_e: a_ij; NaN at lags that were not measured.
        a_std: Its standard uncertainty.
        b_per_e: b_ij; 0 where it is not fitted.
        variance_excess: Overdispersion of variances and covariances, relative to the variance.
        chi_squared: With that in the errors.
        freedom: Degrees of freedom.
    """

    form: Form
    system_gain: float
    system_gain_std: float
    read_variance_dn2: float
    read_variance_dn2_std: float
    gain_read_covariance: float
    a_per_e: Kernel
    a_std: Kernel
    b_per_e: Kernel
    variance_excess: ByLight
    chi_squared: float
    freedom: int


def fit_astier(points: Points, form: Form, response: Shape | None = None) -> AstierFit | None:
    """Fit the series to variances and covariances; None where there are too few.

    Args:
        points: Of one tap.
        form: Which terms.
        response: Its β, found with the means, is undone and held fixed.
    """
    lags = points.lags
    n_lags = len(lags)
    shape = (1 + max((r for r, _ in lags), default=0), 1 + max((c for _, c in lags), default=0))
    per_lag = 2 + (form is Form.FULL_WITH_B)
    n_free = 1 + per_lag * (n_lags + 1)
    known = np.asarray(np.isfinite(points.covariance_dn2).all(axis=0))
    points = points.where(known)
    levels = len(np.unique(points.block[points.signal_dn > 0]))
    if not n_lags or levels < per_lag or (n_lags + 1) * len(points) <= n_free:
        return None
    fit = _Fit(points, form, response or Shape(1.0, 0.0), ((0, 0), *lags), shape)
    return fit.run()


@dataclass(frozen=True)
class _Fit:
    points: Points
    form: Form
    response: Shape
    lags: tuple[tuple[int, int], ...]
    shape: tuple[int, int]

    @property
    def _size(self) -> int:
        return len(self.lags)

    def _kernel(self, values: Vector) -> Kernel:
        kernel = np.zeros(self.shape)
        for (row, column), value in zip(self.lags, values, strict=True):
            kernel[row, column] = value
        return kernel

    def _split(self, p: Vector) -> tuple[float, Kernel, Kernel, Vector]:
        """Return K, a, a·b and n_ij of parameters in units of their sizes."""
        n = self._size
        top = self._electrons_scale
        a = self._kernel(p[1 + n : 1 + 2 * n]) / top
        with_b = self.form is Form.FULL_WITH_B
        ab = self._kernel(p[1 + 2 * n :]) / top**2 if with_b else np.zeros(self.shape)
        return float(p[0]), a, ab, p[1 : 1 + n]

    @cached_property
    def _linear(self) -> Columns:
        """The signal as a straight response would give it, DN."""
        return self.response.linear(self.points.signal_dn)

    @cached_property
    def _electrons_scale(self) -> float:
        p = self.points
        return float(p.signal_dn.max() * p.signal_dn.max() / p.variance_dn2.max())

    def _model(self, p: Vector) -> NDArray[np.float64]:
        """Return C of every lag and point before rounding, DN², (n_lags, n_points)."""
        gain, a, ab, noise = self._split(p)
        x = self._linear
        charge = covariance_model(x / gain, gain, a, ab, self.form)
        picked = np.array([charge[r, c] for r, c in self.lags]) + noise[:, None]
        return np.asarray(self.response.slope(x) ** 2 * picked)

    def _errors(self, p: Vector) -> tuple[Vector, Vector, Vector]:
        """Return residuals, their variances by statistics and V² of each, flattened."""
        model, q = self._model(p), self.points
        fourth = p[0] ** 3 * np.maximum(q.signal_dn, 0.0)
        of_variance = q.variance_variance(model[0], fourth)
        model[0] = variance = rounded_variance(model[0])
        own = np.concatenate([of_variance[None], q.covariance_factor * variance**2])
        seen = np.concatenate([q.variance_dn2[None], q.covariance_dn2])
        size = np.concatenate([variance[None] ** 2, np.zeros((self._size - 1, len(q)))])
        return (seen - model).ravel(), own.ravel(), size.ravel()

    def run(self) -> AstierFit:
        """Fit with weights anew until they stay."""
        at, tau2 = self._start(), np.zeros(len(self.points))
        for _ in range(4):
            _, own, size = self._errors(at)
            spread = np.sqrt(own + np.tile(tau2, self._size) * size)

            def residual(p: Vector, spread: Vector = spread) -> Vector:
                return np.asarray(self._errors(p)[0] / spread)

            solution = solve(residual, at, np.maximum(np.abs(at), 1e-3))
            at = solution.parameters
            tau2 = self._excess(at).tau2(self.points.is_dark)
        return self._result(solution, self._excess(at))

    def _excess(self, at: Vector) -> ByLight:
        n = len(self.points)
        residual, own, size = (part[:n] for part in self._errors(at))
        n_curve = 3 + (self.form is Form.FULL_WITH_B)
        return excess_by_light(residual, own, size, self.points.is_dark, n_curve)

    def _start(self) -> Vector:
        n, q = self._size, self.points
        weight = 1.0 / np.maximum(q.variance_dn2, 1e-3)
        x = self._linear
        flat = q.variance_dn2 / self.response.slope(x) ** 2
        design = np.stack([x, np.ones(len(q))], axis=1) * weight[:, None]
        gain, floor = np.linalg.lstsq(design, (flat - ROUNDING_DN2) * weight, rcond=None)[0]
        extra = n if self.form is Form.FULL_WITH_B else 0
        head = np.array([max(gain, 1e-4), max(floor, 0.01)])
        return np.concatenate([head, np.zeros(n - 1), np.full(n, 1e-4), np.zeros(extra)])

    def _result(self, solution: Solution, found: ByLight) -> AstierFit:
        gain, a, ab, noise = self._split(solution.parameters)
        covariance: Matrix = solution.covariance
        std = np.sqrt(np.diag(covariance))
        n = self._size
        measured = self._kernel(np.ones(n)) > 0
        with np.errstate(divide="ignore", invalid="ignore"):
            b = np.where(ab != 0, ab / a, 0.0)
        return AstierFit(
            form=self.form,
            system_gain=gain,
            system_gain_std=float(std[0]),
            read_variance_dn2=float(noise[0]),
            read_variance_dn2_std=float(std[1]),
            gain_read_covariance=float(covariance[0, 1]),
            a_per_e=np.where(measured, a, np.nan),
            a_std=np.where(measured, self._kernel(std[1 + n : 1 + 2 * n]), np.nan)
            / self._electrons_scale,
            b_per_e=b,
            variance_excess=found,
            chi_squared=float((solution.residual**2).sum()),
            freedom=len(solution.residual) - len(solution.parameters),
        )
