"""Departures that a given model has already: they are a part of what is compared with.

Each is simulated as the model has it, and taken out of what was recorded; offsets, slopes and noise
are fitted beside it. How much of it there is, the recording tells: one number each, its strength.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import isfinite

import numpy as np

from calib.diagnosis.baseline.baseline import Baseline
from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.given.given_model import DIFFERS_SIGMA
from calib.diagnosis.given.parameter_off import ParameterOff
from calib.diagnosis.naming.model import Model
from calib.diagnosis.naming.rebase import rebased
from calib.diagnosis.signatures.changes import change_of
from calib.diagnosis.simulation.response import Responder
from calib.diagnosis.statistics.change import Change
from calib.forward.departure import Departure
from calib.forward.model import Model as ForwardModel
from calib.forward.parameter import parameters_of

ROUNDS = 3
"""The baseline moves by a part of what departures change; after three times by nothing more."""


@dataclass(frozen=True)
class Known:
    """What a given model's departures make of a recording.

    Attributes:
        names: Theirs.
        change: Of the statistics, as the recording has it.
        baseline: Fitted beside them.
        off: Those of which the recording has more or less than the model.
    """

    names: tuple[str, ...]
    change: Change
    baseline: Baseline
    off: tuple[ParameterOff, ...]


def known_departures(
    given: ForwardModel | None, evidence: Evidence, responder: Responder
) -> Known | None:
    """Return what the departures of `given` do; None where it has none."""
    effects = tuple(e for e in given.effects if isinstance(e, Departure)) if given else ()
    if not effects:
        return None
    observed, baseline = evidence.observed(), evidence.baseline
    change = change_of(effects, evidence, responder)
    for _ in range(ROUNDS):
        baseline = rebased(baseline, observed - change, evidence)
        change = change_of(effects, evidence, responder.about(baseline))
    about = responder.about(baseline)
    single = [change_of((e,), evidence, about) - change_of((), evidence, about) for e in effects]
    shares, std = _shares(single, observed - change, evidence)
    off, names = [], tuple(e.name for e in effects)
    for effect, share, error, alone in zip(effects, shares, std, single, strict=True):
        told = _off(effect, share, error)
        if told is not None and abs(share) > DIFFERS_SIGMA * error:
            off.append(told)
            change = change + alone * share
    baseline = rebased(baseline, observed - change, evidence)
    return Known(names, change, baseline, tuple(off))


def beside(known: Known | None, evidence: Evidence) -> Model:
    """Return the model in which nothing has been found yet, beside what is known."""
    observed, baseline = evidence.observed(), evidence.baseline
    if known is not None:
        observed, baseline = observed - known.change, known.baseline
    residual = evidence.point(observed)
    return Model((), None, observed, residual, residual, baseline, baseline)


def _shares(
    single: Sequence[Change], missed: Change, evidence: Evidence
) -> tuple[list[float], list[float]]:
    """Return which share of each is missing, and its standard uncertainty."""
    points, left = [evidence.point(each) for each in single], evidence.point(missed)
    gram = np.array([[evidence.product(a, b) for b in points] for a in points])
    covariance = np.linalg.pinv(gram, rcond=1e-9)
    along = np.array([evidence.product(a, left) for a in points])
    return (covariance @ along).tolist(), np.sqrt(np.maximum(np.diag(covariance), 0.0)).tolist()


def _off(effect: Departure, share: float, error: float) -> ParameterOff | None:
    """Return what the strength of an effect would be; None where it has none."""
    for name, told in parameters_of(type(effect)).items():
        value, neutral = getattr(effect, name), told.neutral
        if isinstance(value, float) and isinstance(neutral, float) and isfinite(neutral):
            size = value - neutral
            if size != 0.0:
                fitted, std = neutral + size * (1.0 + share), abs(size) * error
                return ParameterOff(f"{effect.name}.{name}", value, fitted, std, told.unit)
    return None


def of_known_baseline(known: Known | None, evidence: Evidence) -> Evidence:
    """Return the evidence with the baseline that stands beside what is known."""
    return evidence if known is None else replace(evidence, baseline=known.baseline)
