"""What photon transfer says of one tap."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from calib.transfer.estimate import Estimate
from calib.transfer.photon_transfer.astier import AstierFit, fit_astier
from calib.transfer.photon_transfer.charge_covariance import Form
from calib.transfer.photon_transfer.choice import Choice, choose
from calib.transfer.photon_transfer.curve_fit import CurveFit, Model
from calib.transfer.photon_transfer.estimates import gain_estimate, read_noise_dn, read_noise_e
from calib.transfer.photon_transfer.means import Means, means_of
from calib.transfer.photon_transfer.neighbours import Neighbours, nearest_sigma, neighbours_of
from calib.transfer.photon_transfer.points import Points
from calib.transfer.photon_transfer.rounding_state import Rounding
from calib.transfer.photon_transfer.told import (
    model_answer,
    neighbour_answer,
    number,
    series_answer,
)
from calib.transfer.photon_transfer.turn_off import UsedRange
from calib.transfer.photon_transfer.variance_curve import Shape

_BENT_BY_CHARGE = (Model.BRIGHTER_FATTER, Model.NONLINEAR_AND_BRIGHTER_FATTER)


@dataclass(frozen=True)
class TapTransfer:
    """One tap.

    Attributes:
        tap: Which, from 0.
        points: All of them; `used.use` says which were fitted.
        used: The range, and the turn-off.
        choice: The models of variance (and means), and which is needed.
        means: The means that took part, or None.
        neighbours: Covariances of neighbours.
        has_darks: Whether the signal counts from a dark level.
        gain_and_read: (K, σ_r²) in DN per electron and DN².
        covariance: Of the two.
        shared: (dK, dσ_r²) per standard error that all taps have in common, that of β where the
            unrest of the source makes it.
    """

    tap: int
    points: Points
    used: UsedRange
    choice: Choice
    means: Means | None
    neighbours: tuple[Neighbours, ...]
    has_darks: bool
    gain_and_read: NDArray[np.float64]
    covariance: NDArray[np.float64]
    shared: NDArray[np.float64]

    @cached_property
    def astier(self) -> Mapping[Form, AstierFit]:
        """The brighter-fatter series by form; without those that the points do not determine."""
        points = self.points.where(self.used.use)
        fits = {form: fit_astier(points, form, _response(self.choice)) for form in Form}
        return {form: fit for form, fit in fits.items() if fit is not None}

    @property
    def shape(self) -> Shape:
        """The curve in use."""
        return self.choice.fit.shape

    @property
    def system_gain(self) -> Estimate:
        """K."""
        return gain_estimate(self.gain_and_read, self.covariance)

    @property
    def read_noise_dn(self) -> Estimate:
        """σ_r, before rounding."""
        return read_noise_dn(self.gain_and_read, self.covariance, self.has_darks)

    @property
    def read_noise_e(self) -> Estimate:
        """σ_r in electrons."""
        return read_noise_e(self.gain_and_read, self.covariance, self.has_darks)

    @property
    def rounding(self) -> Rounding:
        """How the read noise was told from rounding."""
        return Rounding.of(float(self.gain_and_read[1]), self.points)

    def answer(self) -> dict[str, Any]:
        """Return it as JSON has it."""
        choice = self.choice
        turn_off = self.used.turn_off_dn
        return {
            "tap": self.tap,
            "system_gain_dn_per_e": self.system_gain.answer(),
            "read_noise_dn": self.read_noise_dn.answer(),
            "read_noise_e": self.read_noise_e.answer(),
            "model": choice.called_for.label,
            "model_of_gain": choice.used.label,
            "why": choice.why,
            "beta_sigma": number(choice.beta_sigma),
            "a00_sigma": number(choice.a00_sigma),
            "bend_sigma": number(choice.bend_sigma),
            "models": {m.label: model_answer(f) for m, f in choice.fits.items()},
            "brighter_fatter_series": {f.value: series_answer(a) for f, a in self.astier.items()},
            "neighbours": [neighbour_answer(n) for n in self.neighbours],
            "turn_off_dn": number(turn_off),
            "range_dn": [number(self.used.lowest_dn), number(self.used.highest_dn)],
            "rounding": self.rounding.value,
            "points": int(self.used.use.sum()),
        }


def tap_transfer(points: Points, used: UsedRange, has_darks: bool) -> TapTransfer:
    """Fit one tap."""
    chosen_points = points.where(used.use)
    means = means_of(chosen_points) if has_darks else None
    rough = choose(chosen_points, means, math.nan)
    shape = rough.fit.shape
    neighbours = neighbours_of(chosen_points, shape.variance(chosen_points.signal_dn))
    choice = rough
    if not rough.with_means and neighbours:
        choice = choose(chosen_points, means, nearest_sigma(neighbours))
    full = None
    if choice.called_for in _BENT_BY_CHARGE:
        full = fit_astier(chosen_points, Form.FULL, _response(choice))
    value, covariance, shared = _gain_and_read(choice.fit, full)
    return TapTransfer(
        points.tap, points, used, choice, means, neighbours, has_darks, value, covariance, shared
    )


def _response(choice: Choice) -> Shape | None:
    """Return the response that the means show; None where they were not fitted."""
    return choice.fit.shape if choice.with_means else None


def _gain_and_read(
    fit: CurveFit, full: AstierFit | None
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Return K and σ_r², their covariance, and what of it β's error brings to all taps alike."""
    shared = _by_beta(fit)
    if full is None:
        value = np.array([fit.shape.system_gain, fit.shape.read_variance_dn2])
        return value, fit.covariance[:2, :2], shared
    value = np.array([full.system_gain, full.read_variance_dn2])
    cross = full.gain_read_covariance
    own = np.array([[full.system_gain_std**2, cross], [cross, full.read_variance_dn2_std**2]])
    return value, own + np.outer(shared, shared), shared


def _by_beta(fit: CurveFit) -> NDArray[np.float64]:
    seen = fit.mean_excess is not None and fit.mean_excess.relative > 0
    if "beta_per_dn" not in fit.names or not seen:
        return np.zeros(2)
    k = fit.names.index("beta_per_dn")
    return np.asarray(fit.covariance[:2, k] / math.sqrt(fit.covariance[k, k]))
