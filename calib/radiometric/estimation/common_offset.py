"""What an offset that all columns share does to their lines: dim or bright, as many DN.

Let e_b be the common offset of block b, DN. With A = (A0; A1) the weighted least squares of a line
at given levels, D the derivatives of a column of the mean slope s̄ to the levels r, and R e what
the joint fit makes of r, a column of slope s = q·s̄ errs by (partitioned least squares; Frisch and
Waugh 1933)

    δDN0 = (A0 + q·B0) e,    δs = (A1 + q·B1) e,    B = −A D R,

since a level that is off shifts the blocks in proportion to the slope. What becomes of the slope
in absolute units, S = s/c with δ ln c = −Σ w_g (R e)_g / r_g, is

    δ ln S = α/q + β,    α = A1 e / s̄,    β = B1 e / s̄ + Σ w_g (R e)_g / r_g.

Only what does not depend on q is an error of the scale. α and β may be correlated; with
κ = cov(α, β)/var α the two terms of α·(1/q + κ) + (β − κ·α) are not, the first being the slope's
and the second the scale's. Var δDN0, var δ ln S and their covariance are then those of one e, so
that no column's covariance matrix has a negative eigenvalue.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.arrays import Columns


@dataclass(frozen=True)
class OffsetOnScale:
    """What the common offset does to slopes in absolute units, relative.

    Attributes:
        line_std: Standard uncertainty α, of a column of the mean slope.
        tilt: κ.
        scale_std: Standard uncertainty of β − κ·α.
        covariance_dn: Covariance of (A0 e, B0 e) with (α, β), (2, 2), DN.
        mean_slope: s̄, DN per µs of reference light.
    """

    line_std: float
    tilt: float
    scale_std: float
    covariance_dn: NDArray[np.float64]
    mean_slope: float

    def slope_relative_std(self, slope: Columns) -> Columns:
        """Return the part of u(S)/S that is not the scale's, for columns of these slopes s."""
        return np.asarray(np.abs(self.mean_slope / slope + self.tilt) * self.line_std)

    def offset_covariance_dn(self, slope: Columns) -> Columns:
        """Return the covariance of DN0 with ln S for columns of these slopes s, DN."""
        share = slope / self.mean_slope
        (line_line, line_scale), (level_line, level_scale) = self.covariance_dn
        return np.asarray(line_line / share + line_scale + level_line + level_scale * share)


@dataclass(frozen=True)
class CommonOffset:
    """Covariance of what common offsets do to lines and levels.

    Attributes:
        covariance: Of (A0 e, A1 e, B0 e, B1 e, R e): DN, DN/µs, DN, DN/µs, 1.
        mean_slope: s̄, DN per µs of reference light.
    """

    covariance: NDArray[np.float64]
    mean_slope: float

    @property
    def of_mean_column(self) -> NDArray[np.float64]:
        """Covariance of (DN0, s, r) for a column of the mean slope."""
        pick = np.delete(np.eye(len(self.covariance)), [2, 3], axis=0)
        pick[0, 2] = pick[1, 3] = 1.0
        return np.asarray(pick @ self.covariance @ pick.T)

    @property
    def slope_std(self) -> float:
        """Standard uncertainty of A1 e, DN/µs: of all columns alike."""
        return float(np.sqrt(self.covariance[1, 1]))

    def offset_variance(self, slope: Columns) -> Columns:
        """Return the variance of DN0 for columns of these slopes s, DN²."""
        c, share = self.covariance, slope / self.mean_slope
        return np.asarray(c[0, 0] + 2.0 * share * c[0, 2] + share**2 * c[2, 2])

    def on_scale(self, by_level: Columns) -> OffsetOnScale:
        """Return what becomes of S, with `by_level` the derivatives of −ln c to r."""
        n = len(self.covariance)
        to_line, to_scale = np.zeros((2, n))
        to_line[1] = 1.0 / self.mean_slope
        to_scale[3], to_scale[4:] = 1.0 / self.mean_slope, by_level
        both = np.array([to_line, to_scale])
        (line, across), (_, scale) = both @ self.covariance @ both.T
        tilt = across / line if line > 0 else 0.0
        return OffsetOnScale(
            line_std=float(np.sqrt(line)),
            tilt=float(tilt),
            scale_std=float(np.sqrt(max(scale - tilt * across, 0.0))),
            covariance_dn=self.covariance[[0, 2]] @ both.T,
            mean_slope=self.mean_slope,
        )


def common_offset(
    design: NDArray[np.float64],
    weight: Columns,
    estimator: NDArray[np.float64],
    block_covariance_dn2: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Return the covariance of (A0 e, A1 e, B0 e, B1 e, R e).

    Args:
        design: Derivatives of the blocks' means to offset, slope and levels, (n, 2 + n_levels).
        weight: Of each block, (n,).
        estimator: That of the joint fit, (2 + n_levels, n).
        block_covariance_dn2: Of e, (n, n).
    """
    root = np.sqrt(weight)
    line = np.linalg.pinv(design[:, :2] * root[:, None]) * root
    by_levels = -line @ design[:, 2:] @ estimator[2:]
    rows = np.vstack([line, by_levels, estimator[2:]])
    return np.asarray(rows @ block_covariance_dn2 @ rows.T)
