"""The effects that bend a photon-transfer curve, and the curve's parameters that stand for them."""

from dataclasses import fields

from calib.diagnosis.answer.estimate import Estimate
from calib.forward.departure import Departure
from calib.forward.effects.brighter_fatter import BrighterFatter
from calib.forward.effects.nonlinearity import Nonlinearity
from calib.transfer.photon_transfer.curve_fit import CurveFit, Model
from calib.transfer.photon_transfer.variance_curve import Shape

EFFECTS = {"beta_per_dn": Nonlinearity.name, "a00_per_e": BrighterFatter.name}
"""Of each parameter that bends the curve."""


def names_of(model: Model) -> tuple[str, ...]:
    """Return the effects of `model`."""
    return tuple(EFFECTS[name] for name in model.value)


def departure(name: str, shape: Shape) -> Departure:
    """Return the effect as the curve has it."""
    if name == Nonlinearity.name:
        return Nonlinearity(shape.beta_per_dn)
    return BrighterFatter(**{n: max(a, 0.0) for n, a in _neighbours(shape.a00_per_e).items()})


def parameters(name: str, fit: CurveFit) -> dict[str, Estimate]:
    """Return the effect's parameters with their standard uncertainties.

    Of the brighter-fatter effect the sums tell what a pixel loses, and not to which neighbours: it
    is shared out as the effect's ordinary strengths are.
    """
    if name == Nonlinearity.name:
        return {"beta_per_dn": Estimate(fit.shape.beta_per_dn, fit.std("beta_per_dn"), "1/DN")}
    own, std = _neighbours(fit.shape.a00_per_e), _neighbours(fit.std("a00_per_e"))
    return {n: Estimate(own[n], abs(std[n]), "1/e-") for n in own}


def _neighbours(a00_per_e: float) -> dict[str, float]:
    """Return what each neighbour takes, so that all eight together take -a00."""
    usual = BrighterFatter()
    values = {f.name: float(getattr(usual, f.name)) for f in fields(usual)}
    lost = 2.0 * (usual.row_per_e + usual.column_per_e) + 4.0 * usual.corner_per_e
    return {name: -a00_per_e * value / lost for name, value in values.items()}
