"""How well a curve that was fitted to some blocks predicts the sums of others.

The deviance is minus twice the log predictive density, normal: a mean or variance left out differs
from the fitted curve by its own statistics, by the unrest of the source (eta) or the overdispersion
of the variances (tau) as the other blocks show them, and by what these leave uncertain of the
curve's parameters (linear about the fit).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.naming.heldout import FOLDS, HeldOut
from calib.transfer.photon_transfer.curve_data import CurveData
from calib.transfer.photon_transfer.curve_fit import CurveFit, Model, fit_curve
from calib.transfer.photon_transfer.means import Means, means_of
from calib.transfer.photon_transfer.points import Points

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Predicted:
    """Sums of blocks, variances first and then means, against what a curve expects of them.

    Attributes:
        residual: Seen less expected, (n,).
        covariance: Of these, (n, n).
        least: Variances of them for a curve that is right: statistics, eta and tau alone, (n,).
    """

    residual: Floats
    covariance: Floats
    least: Floats

    @property
    def deviance(self) -> float:
        """Minus twice the log predictive density, without n ln 2 pi."""
        white = np.linalg.solve(self.covariance, self.residual)
        return float(self.residual @ white + np.linalg.slogdet(self.covariance)[1])


def left_out(points: Points, means: Means | None, model: Model) -> tuple[Predicted, ...]:
    """Return all blocks, each fold of them left out of the fit in turn.

    A fold takes every fourth block by its signal, so that the curve is never led beyond its ends
    by more than a few blocks.
    """
    return tuple(of_fold(points, means, model, fold) for fold in folds_of(points))


def held_out(folds: Sequence[Predicted]) -> HeldOut:
    """Return the deviance of what was left out."""
    return HeldOut(sum(f.deviance for f in folds), sum(len(f.residual) for f in folds))


def saturated(folds: Sequence[Predicted]) -> float:
    """Return what a curve without error would have on average, with the folds' eta and tau.

    What a source's unrest and scattering variances do no curve predicts.
    """
    return float(sum(len(f.least) + np.log(f.least).sum() for f in folds))


def folds_of(points: Points) -> tuple[NDArray[np.intp], ...]:
    """Return blocks in groups that are as unlike as can be, by signal."""
    blocks, first = np.unique(points.block, return_index=True)
    ordered = blocks[np.lexsort((points.signal_dn[first], ~points.is_dark[first]))]
    return tuple(np.sort(ordered[k::FOLDS]) for k in range(FOLDS))


def of_fold(points: Points, means: Means | None, model: Model, fold: NDArray[np.intp]) -> Predicted:
    """Return what the fit of all other blocks says of those in `fold`."""
    out = np.isin(points.block, fold)
    others = points.where(~out)
    known = means_of(others) if means is not None else None
    fit = fit_curve(others, known, model)
    left = _means_left_out(means, known, fold)
    return predicted(fit, CurveData(points.where(out), left, fit.data.names))


def predicted(fit: CurveFit, data: CurveData) -> Predicted:
    """Return `data` against a fit to other blocks."""
    at, scale = fit.solution.parameters, fit.data.scale

    def residuals(parameters: Floats) -> Floats:
        of_variances = data.variance_residuals(data.shape(parameters))
        return np.concatenate([of_variances, data.mean_residuals(parameters)])

    _, own_v, size_v = data.variance_errors(data.shape(at))
    _, own_m, size_m = data.mean_errors(at)
    eta = fit.mean_excess.relative if fit.mean_excess is not None else 0.0
    tau2 = fit.variance_excess.tau2(data.points.is_dark)
    least = np.concatenate([own_v + tau2 * size_v, own_m + eta**2 * size_m])
    steps = 1e-4 * np.diag(scale)
    slopes = [(residuals(at + s) - residuals(at - s)) / (2.0 * s.max()) for s in steps]
    jacobian = np.stack(slopes, axis=1)
    spread = jacobian @ fit.solution.covariance @ jacobian.T
    return Predicted(residuals(at), np.diag(least) + spread, least)


def _means_left_out(
    means: Means | None, known: Means | None, fold: NDArray[np.intp]
) -> Means | None:
    """Return the means of blocks in `fold` whose level the others know, numbered as theirs."""
    if means is None or known is None:
        return None
    levels = means.levels[means.group]
    chosen = np.isin(means.block, fold) & np.isin(levels, known.levels)
    return replace(
        means,
        block=means.block[chosen],
        exposure_us=means.exposure_us[chosen],
        group=np.searchsorted(known.levels, levels[chosen]),
        levels=known.levels,
        signal_dn=means.signal_dn[chosen],
        spread=means.spread[chosen],
        samples=means.samples[chosen],
    )
