"""Which bends the curve has, how sure that is, and which model K is taken from.

Two questions are kept apart. *What is called for*: where means against exposure tell of the
response, its bend (β) and the brighter-fatter effect (a00) are fitted together, and each is called
for that lies three standard errors from 0 on its own side; a00 only where it is negative, since
the effect takes variance away. Standard errors hold the overdispersion that was found, and
Student's t its degrees of freedom. Without such means variances alone cannot tell one from the
other, and a bend is just a bend, unless neighbours correlate as the effect has it.

*What K is taken from*: a bend too weak to be seen still moves a straight line's K by several of
its standard errors, so that dropping it on a test would make K surer than it is (a bend of two
standard errors moves K by four or five). Bends therefore stay free, seen or not, and K pays for
them with its standard error. Left out is an a00 that contradicts physics, two standard errors
above 0: then something else is at work, and a00 would bend K the wrong way.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.stats import norm, t

from calib.transfer.photon_transfer.curve_fit import CurveFit, Model, fit_curve
from calib.transfer.photon_transfer.means import Means
from calib.transfer.photon_transfer.overdispersion import Excess
from calib.transfer.photon_transfer.points import Points

NEEDED_SIGMA = 3.0
_IMPOSSIBLE_SIGMA = 2.0
_FEWEST_FLATS = 3


@dataclass(frozen=True)
class Choice:
    """The models that were fitted, what is called for and what is used.

    Attributes:
        fits: By model.
        called_for: The simplest model that has all that is seen.
        used: The model whose K and read noise are reported.
        with_means: Whether the means took part.
        beta_sigma: How far β lies from 0 beside a00, in standard errors; NaN without means.
        a00_sigma: How far a00 lies from 0 beside β, in standard errors; negative as the effect has
            it; NaN without means.
        bend_sigma: How far the curvature of variance against mean alone lies from 0, in standard
            errors; negative where variance bends down.
        why: One sentence.
    """

    fits: Mapping[Model, CurveFit]
    called_for: Model
    used: Model
    with_means: bool
    beta_sigma: float
    a00_sigma: float
    bend_sigma: float
    why: str

    @property
    def fit(self) -> CurveFit:
        """That of the model in use."""
        return self.fits[self.used]


def significance(value: float, std: float, found: Excess | None) -> float:
    """Return value/std as a normal number: Student's t where errors come from the scatter."""
    if not np.isfinite(std) or std <= 0:
        return 0.0
    ratio = value / std
    if found is None or found.relative == 0 or found.freedom < 1:
        return float(ratio)
    tail = float(t.logsf(abs(ratio), found.freedom))
    return float(np.sign(ratio) * norm.isf(np.exp(tail))) if tail > -600 else float(ratio)


def choose(points: Points, means: Means | None, neighbours_sigma: float) -> Choice:
    """Fit all models and choose.

    Args:
        points: Of one tap, those in use.
        means: Of the same blocks, or None.
        neighbours_sigma: How surely covariances of neighbours grow as the brighter-fatter effect
            has it; NaN where there are none.
    """
    straight = fit_curve(points, means, Model.STRAIGHT)
    if len(np.unique(points.block[~points.is_dark])) < _FEWEST_FLATS:
        why = "flats at fewer than three exposures: a straight line, and no word on its bend"
        nan = float("nan")
        fits = {Model.STRAIGHT: straight}
        return Choice(fits, Model.STRAIGHT, Model.STRAIGHT, False, nan, nan, nan, why)
    bend = fit_curve(points, None, Model.QUADRATIC)
    sigma = significance(bend.shape.curvature, bend.std("curvature"), bend.variance_excess.flats)
    if means is None:
        return _by_variance(points, straight, bend, sigma, neighbours_sigma)
    return _with_means(points, means, straight, sigma)


def _with_means(points: Points, means: Means, straight: CurveFit, bend_sigma: float) -> Choice:
    names = (Model.NONLINEAR, Model.BRIGHTER_FATTER, Model.NONLINEAR_AND_BRIGHTER_FATTER)
    fits = {Model.STRAIGHT: straight, **{m: fit_curve(points, means, m) for m in names}}
    both = fits[Model.NONLINEAR_AND_BRIGHTER_FATTER]
    beta = significance(both.shape.beta_per_dn, both.std("beta_per_dn"), both.mean_excess)
    found = both.variance_excess.flats
    a00 = significance(both.shape.a00_per_e, both.std("a00_per_e"), found)
    called_for = {
        (False, False): Model.STRAIGHT,
        (True, False): Model.NONLINEAR,
        (False, True): Model.BRIGHTER_FATTER,
        (True, True): Model.NONLINEAR_AND_BRIGHTER_FATTER,
    }[abs(beta) >= NEEDED_SIGMA, a00 <= -NEEDED_SIGMA]
    used = both.model if a00 < _IMPOSSIBLE_SIGMA else Model.NONLINEAR
    why = _why(fits, called_for, beta, a00)
    return Choice(fits, called_for, used, True, beta, a00, bend_sigma, why)


def _by_variance(
    points: Points, straight: CurveFit, bend: CurveFit, bend_sigma: float, neighbours_sigma: float
) -> Choice:
    """Choose from variances alone."""
    shapes = {m: fit_curve(points, None, m) for m in (Model.NONLINEAR, Model.BRIGHTER_FATTER)}
    fits = {Model.STRAIGHT: straight, Model.QUADRATIC: bend, **shapes}
    seen = f"variance against mean bends by {bend_sigma:+.1f} standard errors"
    if abs(bend_sigma) < NEEDED_SIGMA:
        called_for, used = Model.STRAIGHT, Model.QUADRATIC
        why = f"{seen}: a straight line is enough, the bend stays in K's standard error"
    elif bend_sigma < 0 and neighbours_sigma >= NEEDED_SIGMA:
        called_for = used = Model.BRIGHTER_FATTER
        why = (
            f"{seen}, and neighbours correlate as the brighter-fatter effect has it "
            f"({neighbours_sigma:.1f} standard errors)"
        )
    else:
        called_for = used = Model.QUADRATIC
        why = (
            f"{seen}; whether the response or the charge does it, flats of one level at five "
            "exposures or more would tell"
        )
    nan = float("nan")
    return Choice(fits, called_for, used, False, nan, nan, bend_sigma, why)


def _why(fits: Mapping[Model, CurveFit], called_for: Model, beta: float, a00: float) -> str:
    effect = "takes variance away" if a00 < 0 else "would add variance, which it cannot"
    said = (
        f"fitted together, the response's bend lies {beta:+.1f} standard errors from none and a "
        f"brighter-fatter term {a00:+.1f} ({effect})"
    )
    if called_for is Model.STRAIGHT:
        return f"{said}: neither is called for"
    gain = fits[Model.STRAIGHT].aicc - fits[called_for].aicc
    return f"{said}; AICc falls by {gain:.1f} from the straight line's to this model's"
