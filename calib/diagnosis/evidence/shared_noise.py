"""How statistics of what a line's pixels have in common scatter where lines share noise.

Line noise, jitter or flicker moves all taps of a line together, or each for itself. Each tap's
variance, their covariances, and of a frame those of its rows then measure the same few numbers, and
do not tell the shared variance as often as there are statistics.

Covariances of products of means that are jointly normal: cov(xy, zu) = s_xz s_yu + s_xu s_yz for
each pair of lines (Isserlis, Biometrika 12, 134 (1918)), divided by the degrees of freedom.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.statistics.counts import Counts

Floats = NDArray[np.float64]

LEAST = 0.01
"""Of a correlation's eigenvalues: taps are alike to a few per cent, and no closer."""


@dataclass(frozen=True)
class SharedNoise:
    """Noise of the taps' means in one block.

    Attributes:
        counts: Of the sensor.
        white: Variance of each tap's mean without shared noise, DN^2, (n_taps,).
        shared: What all taps of a row share, DN^2.
        rows_share: The part of it that all rows of a frame share, 0 to 1; 0 for lines.
        of_taps: What each tap has besides that for itself, DN^2.
    """

    counts: Counts
    white: Floats
    shared: float
    rows_share: float
    of_taps: float = 0.0

    def growth(self) -> Floats:
        """Return by how much shared noise raises the standard deviations, (n_taps + 3,).

        Of each tap's variance, of the mean covariance of two taps, and of covariances one and two
        lines apart; of a frame, of its rows one apart, and of frames.
        """
        with_it, without = (np.diag(each.covariance()) for each in (self, self._quiet))
        raised = np.sqrt(with_it / np.where(without > 0, without, 1.0))
        return np.where(without > 0, raised, 1.0)

    def whitener(self) -> Floats:
        """Return what makes the standardised statistics independent, (n_taps + 3, n_taps + 3).

        It is the symmetric one: each statistic stays in its place as far as that can be.
        """
        covariance = self.covariance()
        std = np.sqrt(np.diag(covariance))
        scale = np.where(std > 0, std, 1.0)
        correlation = covariance / np.outer(scale, scale)
        lone = std <= 0
        correlation[lone], correlation[:, lone] = 0.0, 0.0
        correlation[lone, lone] = 1.0
        values, axes = np.linalg.eigh(correlation)
        return np.asarray((axes / np.sqrt(np.maximum(values, LEAST))) @ axes.T)

    @property
    def _quiet(self) -> "SharedNoise":
        return SharedNoise(self.counts, self.white, 0.0, 0.0)

    def covariance(self) -> Floats:
        """Return the covariance of the statistics, times the degrees of freedom of one row."""
        present = self.counts.present.astype(float)
        taps = [(t, t) for t in range(len(self.white))]
        pairs = list(self.counts.shared_rows)
        products = np.array(taps + pairs)
        where = present[:, products[:, 0]] * present[:, products[:, 1]]
        rows = where.sum(axis=0)
        same = where.T @ where
        common = self.shared + self.of_taps * np.eye(len(self.white))
        sigma = np.diag(self.white) + common
        a, b = products.T
        one = _of_products(sigma, a, b)
        other = _of_products(self.rows_share * common, a, b)
        of_each = same * one + (np.outer(rows, rows) - same) * other
        of_each = of_each / np.outer(rows, rows)
        mean = np.zeros((len(taps) + 1, len(products)))
        mean[: len(taps), : len(taps)] = np.eye(len(taps))
        mean[len(taps), len(taps) :] = 1.0 / max(len(pairs), 1)
        found = np.zeros((len(taps) + 3,) * 2)
        found[:-2, :-2] = mean @ of_each @ mean.T
        self._fill_lags(found)
        return found

    def _fill_lags(self, found: Floats) -> None:
        """Set what covariances of rows, of which `found` has none yet, have with all others."""
        n_rows = len(self.counts.present)
        taps = self.counts.taps_of_row
        common = self.shared + self.of_taps / taps
        near, far = float(self.white.mean()) / taps + common, self.rows_share * common
        if n_rows == 1:
            found[-2:] = found[:, -2:] = 0.0
            found[-2, -2] = found[-1, -1] = near**2
            return
        # What two frames share goes with nothing that one of them tells.
        found[-2:-1] = found[:, -2:-1] = 2.0 * far**2 + 4.0 * far * (near - far) / n_rows
        found[-2, -2] = 2.0 * far**2 + (near**2 - far**2) / (n_rows - 1)
        found[-1:] = found[:, -1:] = 0.0
        found[-1, -1] = (far + (near - far) / n_rows) ** 2


def _of_products(sigma: Floats, a: NDArray[np.intp], b: NDArray[np.intp]) -> Floats:
    """Return the covariances of products of the means `a` and `b`, whose own are `sigma`."""
    straight = sigma[np.ix_(a, a)] * sigma[np.ix_(b, b)]
    return np.asarray(straight + sigma[np.ix_(a, b)] * sigma[np.ix_(b, a)])
