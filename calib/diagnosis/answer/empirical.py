"""What remains of the means as a labelled empirical term that an amended model carries.

    mean_b + sum_k c_k h_k(x_b),    h_k piecewise linear between knots, 1 at the k-th, 0 at others

x is the variable among signal, time, exposure, level and temperature that takes the most of the
remainder off, each knot paid for by a deviance of 2 (Akaike). The c_k are fitted by generalised
least squares beside offset and slope of each pixel.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from calib.diagnosis.answer.empirical_term import EmpiricalTerm
from calib.diagnosis.baseline.baseline import Baseline, fit_lines
from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.naming.model import Model
from calib.diagnosis.naming.remainder import CERTAIN_SIGMA, worst
from calib.forward.effects.empirical import FOLLOWS, Empirical

Floats = NDArray[np.float64]

MOST_KNOTS = 8
CHANCE = 1e-8
"""A term that chance makes more often than this is none."""


def empirical_term(model: Model, evidence: Evidence) -> EmpiricalTerm | None:
    """Return the term where the means hold a remainder that is not chance and that it describes."""
    look, sigma = worst(model, evidence)
    if sigma <= CERTAIN_SIGMA or look.statistic != "mean":
        return None
    return best_term(model, evidence)


def best_term(model: Model, evidence: Evidence) -> EmpiricalTerm | None:
    """Return the term that describes the most; None where chance would do as much."""
    found = [_fitted(name, x, model, evidence) for name, x in _variables(evidence).items()]
    told = [term for term in found if term is not None]
    if not told:
        return None
    best = max(told, key=lambda term: term.explained - 2.0 * len(term.effect.at))
    tried = len(FOLLOWS)
    by_chance = tried * float(chi2.sf(best.explained, len(best.effect.at)))
    return best if by_chance < CHANCE else None


def with_term(base: Baseline, term: EmpiricalTerm, evidence: Evidence) -> Baseline:
    """Return offsets and slopes as they are beside the term."""
    x = _variables(evidence)[term.effect.follows]
    added = np.interp(x, term.effect.at, term.effect.add_dn)
    first = evidence.baseline
    weight = np.where(first.usable, evidence.n[:, None, None] / first.variance_dn2, 0.0)
    means = np.broadcast_to(added[:, None, None], first.mean_dn.shape)
    offset, slope = fit_lines(means, first.dose, weight)
    return replace(base, offset_dn=base.offset_dn - offset, slope=base.slope - slope)


def _variables(evidence: Evidence) -> dict[str, Floats]:
    table = evidence.table
    return {
        "signal": evidence.signal_dn,
        "time": table.mid_s,
        "exposure": table.exposure_us,
        "level": table.level,
        "temperature": table.temperature_c,
    }


def _knots(x: Floats) -> Floats:
    values = np.unique(x)
    if len(values) > MOST_KNOTS:
        values = np.unique(np.quantile(values, np.linspace(0.0, 1.0, MOST_KNOTS)))
    return values


def _fitted(name: str, x: Floats, model: Model, evidence: Evidence) -> EmpiricalTerm | None:
    knots = _knots(x)
    if len(knots) < 3:
        return None
    shape = model.residual.means.shape
    hats = [np.interp(x, knots, row) for row in np.eye(len(knots))]
    directions = [evidence.space.project(np.broadcast_to(hat[:, None], shape)) for hat in hats]
    product = evidence.space.product
    gram = np.array([[product(a, b) for b in directions] for a in directions])
    along = np.array([product(d, model.residual.means) for d in directions])
    # What offset and slope absorb has no length, and gets no coefficient.
    inverse = np.linalg.pinv(gram, rcond=1e-6, hermitian=True)
    explained = float(along @ inverse @ along)
    left = product(model.residual.means, model.residual.means) - evidence.space.degrees_of_freedom
    return EmpiricalTerm(
        Empirical(name, tuple(knots.tolist()), tuple((inverse @ along).tolist())),
        tuple(np.sqrt(np.maximum(np.diag(inverse), 0.0)).tolist()),
        explained,
        float(np.clip(explained / max(left, 1e-9), 0.0, 1.0)),
    )
