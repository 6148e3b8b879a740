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

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.stats import norm, t

from calib.transfer.photon_transfer.curve_fit import CurveFit, Model, fit_curve
from calib.transfer.photon_transfer.means import Means
from calib.transfer.photon_transfer.overdispersion import Excess
from calib.transfer.photon_transfer.points import Points

NEEDED_SIGMA = 3.0
_IMPOSSIBLE_SIGMA = 2.0
_FEWEST_FLATS = 3
_NAN = float("nan")
_WITHOUT_MEANS = (Model.STRAIGHT, Model.QUADRATIC, Model.NONLINEAR, Model.BRIGHTER_FATTER)
_WITH_MEANS = (
    Model.STRAIGHT,
    Model.NONLINEAR,
    Model.BRIGHTER_FATTER,
    Model.NONLINEAR_AND_BRIGHTER_FATTER,
)


class Fits(Mapping[Model, CurveFit]):
    """A tap's models, each fitted when it is first asked for: few are looked at by most."""

    def __init__(self, points: Points, means: Means | None, models: tuple[Model, ...]) -> None:
        """Name the models that the points (those in use) and means allow."""
        self._points, self._means, self._models = points, means, models
        self._found: dict[Model, CurveFit] = {}

    def __getitem__(self, model: Model) -> CurveFit:
        """Return the fit of one of the models."""
        if model not in self._models:
            raise KeyError(model)
        if model not in self._found:
            self._found[model] = fit_curve(self._points, self._means, model)
        return self._found[model]

    def __iter__(self) -> Iterator[Model]:
        """Yield the models, the simplest first."""
        return iter(self._models)

    def __len__(self) -> int:
        """Return how many there are."""
        return len(self._models)

    @cached_property
    def bend_sigma(self) -> float:
        """How far the curvature of variance against mean alone lies from 0, in standard errors."""
        if not self.tell_of_a_bend:
            return float("nan")
        on_its_own = self._means is None and Model.QUADRATIC in self
        bend = (
            self[Model.QUADRATIC] if on_its_own else fit_curve(self._points, None, Model.QUADRATIC)
        )
        excess = bend.variance_excess.flats
        return significance(bend.shape.curvature, bend.std("curvature"), excess)

    @property
    def tell_of_a_bend(self) -> bool:
        """Whether there are points enough for more than a straight line."""
        return len(self) > 1


@dataclass(frozen=True)
class Choice:
    """The models that can be fitted, what is called for and what is used.

    Attributes:
        fits: By model.
        called_for: The simplest model that has all that is seen.
        used: The model whose K and read noise are reported.
        with_means: Whether the means took part.
        beta_sigma: How far β lies from 0 beside a00, in standard errors; NaN without means.
        a00_sigma: How far a00 lies from 0 beside β, in standard errors; negative as the effect has
            it; NaN without means.
        reason: One sentence, but for what `why` adds.
    """

    fits: Fits
    called_for: Model
    used: Model
    with_means: bool
    beta_sigma: float
    a00_sigma: float
    reason: str

    @property
    def fit(self) -> CurveFit:
        """That of the model in use."""
        return self.fits[self.used]

    @property
    def bend_sigma(self) -> float:
        """How far variance against mean alone bends from a straight line, in standard errors.

        Negative where it bends down, NaN where it is not tested.
        """
        return self.fits.bend_sigma

    @property
    def why(self) -> str:
        """One sentence."""
        if not self.with_means:
            return self.reason
        if self.called_for is Model.STRAIGHT:
            return f"{self.reason}: neither is called for"
        gain = self.fits[Model.STRAIGHT].aicc - self.fits[self.called_for].aicc
        return f"{self.reason}; AICc falls by {gain:.1f} from the straight line's to this model's"


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
    """Fit what the choice takes, and choose.

    Args:
        points: Of one tap, those in use.
        means: Of the same blocks, or None.
        neighbours_sigma: How surely covariances of neighbours grow as the brighter-fatter effect
            has it; NaN where there are none.
    """
    if len(np.unique(points.block[~points.is_dark])) < _FEWEST_FLATS:
        why = "flats at fewer than three exposures: a straight line, and no word on its bend"
        fits = Fits(points, means, (Model.STRAIGHT,))
        return Choice(fits, Model.STRAIGHT, Model.STRAIGHT, False, _NAN, _NAN, why)
    if means is None:
        return _by_variance(Fits(points, None, _WITHOUT_MEANS), neighbours_sigma)
    return _with_means(Fits(points, means, _WITH_MEANS))


def _with_means(fits: Fits) -> Choice:
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
    effect = "takes variance away" if a00 < 0 else "would add variance, which it cannot"
    said = (
        f"fitted together, the response's bend lies {beta:+.1f} standard errors from none and a "
        f"brighter-fatter term {a00:+.1f} ({effect})"
    )
    return Choice(fits, called_for, used, True, beta, a00, said)


def _by_variance(fits: Fits, neighbours_sigma: float) -> Choice:
    """Choose from variances alone."""
    seen = f"variance against mean bends by {fits.bend_sigma:+.1f} standard errors"
    if abs(fits.bend_sigma) < NEEDED_SIGMA:
        called_for, used = Model.STRAIGHT, Model.QUADRATIC
        why = f"{seen}: a straight line is enough, the bend stays in K's standard error"
    elif fits.bend_sigma < 0 and neighbours_sigma >= NEEDED_SIGMA:
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
    return Choice(fits, called_for, used, False, _NAN, _NAN, why)
