"""What a curve is fitted to: residuals of variances and means, and how large they may be."""

from dataclasses import dataclass

import numpy as np

from calib.transfer.photon_transfer.gauss_newton import Vector
from calib.transfer.photon_transfer.means import Means
from calib.transfer.photon_transfer.points import Points
from calib.transfer.photon_transfer.variance_curve import ROUNDING_DN2, Shape, rounded_variance


@dataclass(frozen=True)
class CurveData:
    """The data, and the sizes that parameters have.

    Attributes:
        points: Of one tap.
        means: Of the same blocks, or None.
        names: Of the curve's free parameters, as in `Shape`. Behind them stand the responses of
            the levels, DN per µs, and the exposure's offset, µs, where there are means.
    """

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
        found[:2] = np.linalg.lstsq(design, (v - ROUNDING_DN2) * weight, rcond=None)[0]
        found[0] = max(found[0], 1e-3 * self.scale[0])
        if self.means is not None:
            found[len(self.names) : -1] = self._responses()
        return found

    def shape(self, parameters: Vector) -> Shape:
        """Return the curve."""
        return Shape(**dict(zip(self.names, map(float, parameters), strict=False)))

    def variance_residuals(self, shape: Shape) -> Vector:
        """Return what the variances are beyond a curve's."""
        return self.points.variance_dn2 - shape.variance(self.points.signal_dn)

    def mean_residuals(self, parameters: Vector) -> Vector:
        """Return what the means are beyond what is expected; none without means."""
        return self._of_means(parameters, self.shape(parameters))[0]

    def variance_errors(self, shape: Shape) -> tuple[Vector, Vector, Vector]:
        """Return residuals of the variances, their variances by statistics, and V²."""
        p = self.points
        before = shape.variance_before_rounding(p.signal_dn)
        expected = rounded_variance(before)
        fourth = shape.fourth_cumulant(p.signal_dn)
        return p.variance_dn2 - expected, p.variance_variance(before, fourth), expected**2

    def mean_errors(self, parameters: Vector) -> tuple[Vector, Vector, Vector]:
        """Return residuals of the means, their variances by statistics, and s²; none without."""
        shape = self.shape(parameters)
        residual, expected = self._of_means(parameters, shape)
        if self.means is None:
            return residual, expected, expected
        return residual, shape.variance(expected) / self.means.samples, expected**2

    def _of_means(self, parameters: Vector, shape: Shape) -> tuple[Vector, Vector]:
        """Return residuals of the means, and what is expected of them; none without."""
        m = self.means
        if m is None:
            return np.empty(0), np.empty(0)
        rate, offset = parameters[len(self.names) : -1], parameters[-1]
        linear = rate[m.group] * (m.exposure_us + offset)
        expected = shape.mean(linear, m.spread)
        return m.signal_dn - expected, expected
