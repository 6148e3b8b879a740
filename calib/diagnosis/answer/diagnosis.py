"""What a diagnosis says: frozen, with units, ready for JSON, a report and an amended model."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.answer.absorbed import Absorbed
from calib.diagnosis.answer.empirical_term import EmpiricalTerm
from calib.diagnosis.answer.estimate import Estimate
from calib.diagnosis.answer.figures import Figures
from calib.diagnosis.answer.next_measurement import NextMeasurement
from calib.diagnosis.answer.radiance_error import RadianceError
from calib.diagnosis.given.parameter_off import ParameterOff
from calib.forward.departure import Departure

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Where:
    """Where something lives.

    Attributes:
        statistic: Which statistic shows it.
        depends_on: What it follows.
        columns: First and last column.
        blocks: In which it is strongest.
        text: One sentence for an operator.
    """

    statistic: str
    depends_on: tuple[str, ...]
    columns: tuple[int, int]
    blocks: tuple[str, ...]
    text: str

    def answer(self) -> dict[str, Any]:
        """Return it as JSON knows it."""
        return {
            "statistic": self.statistic,
            "depends_on": list(self.depends_on),
            "columns": list(self.columns),
            "blocks": list(self.blocks),
            "text": self.text,
        }


@dataclass(frozen=True)
class NamedCandidate:
    """A name that a finding may have."""

    effect: str
    probability: float
    heldout_deviance: float

    def answer(self) -> dict[str, Any]:
        """Return it as JSON knows it."""
        return {
            "effect": self.effect,
            "probability": self.probability,
            "heldout_deviance": self.heldout_deviance,
        }


@dataclass(frozen=True)
class Finding:
    """An effect that was found.

    Attributes:
        effect: As fitted; its name is the likeliest.
        candidates: All names that the data cannot tell apart, the likeliest first.
        significance_sigma: By how many standard deviations it is seen.
        where: Where.
        parameters: As fitted.
        heldout_before, heldout_after: Deviance of blocks left out, without it and with it.
        fraction_explained: Of what the model without it misses there.
        sentence: What an operator is told of it.
        hid_as: What the plain fit mistook it for; empty where that is not known.
        absorbed: The same in numbers.
    """

    effect: Departure
    candidates: tuple[NamedCandidate, ...]
    significance_sigma: float
    where: Where
    parameters: dict[str, Estimate]
    heldout_before: float
    heldout_after: float
    fraction_explained: float
    sentence: str = ""
    hid_as: str = ""
    absorbed: tuple[Absorbed, ...] = ()

    def answer(self) -> dict[str, Any]:
        """Return it as JSON knows it."""
        return {
            "effect": self.effect.name,
            "probability": self.candidates[0].probability,
            "candidates": [c.answer() for c in self.candidates],
            "significance_sigma": self.significance_sigma,
            "where": self.where.answer(),
            "physics": self.effect.physics,
            "parameters": {name: e.answer() for name, e in self.parameters.items()},
            "heldout_deviance_before": self.heldout_before,
            "heldout_deviance_after": self.heldout_after,
            "fraction_explained": self.fraction_explained,
            "sentence": self.sentence,
            "hid_as": {"text": self.hid_as, "coefficients": [a.answer() for a in self.absorbed]},
        }


@dataclass(frozen=True)
class Unexplained:
    """A remainder without a name; what an amended model carries of it, labelled as empirical."""

    significance_sigma: float
    where: Where
    term: EmpiricalTerm | None = None

    def answer(self) -> dict[str, Any]:
        """Return it as JSON knows it."""
        return {
            "significance_sigma": self.significance_sigma,
            "where": self.where.answer(),
            "empirical": None if self.term is None else self.term.answer(),
        }


@dataclass(frozen=True)
class Fit:
    """A model's links and how well they predict what they did not see."""

    model: tuple[str, ...]
    heldout_deviance: float
    dof: int

    def answer(self) -> dict[str, Any]:
        """Return it as JSON knows it."""
        return {
            "model": list(self.model),
            "heldout_deviance": self.heldout_deviance,
            "dof": self.dof,
        }


AMBIGUOUS = 0.05
"""A second name that is so probable makes a finding ambiguous."""


@dataclass(frozen=True)
class Diagnosis:
    """The answer.

    Attributes:
        baseline, final: The plain model, and that with all that was found.
        findings: The strongest first.
        unexplained: What remains without a name.
        not_testable: What the plan could not have shown, with the reason, by the effect's name.
        model_parameters: Numbers of a given model that are off.
        figures: What a report draws.
        summary: The verdict in a sentence.
        radiance: What the plain calibration gets wrong of it.
        remarks: What limits the answer, and what was looked for and is not there, a sentence each.
    """

    baseline: Fit
    findings: tuple[Finding, ...]
    final: Fit
    unexplained: Unexplained | None
    not_testable: dict[str, str]
    model_parameters: tuple[ParameterOff, ...]
    figures: Figures
    summary: str = ""
    radiance: RadianceError | None = None
    remarks: tuple[str, ...] = ()
    next_measurement: NextMeasurement | None = None

    @property
    def verdict(self) -> str:
        """In order of precedence: unexplained, ambiguous, explained, consistent."""
        if self.unexplained is not None:
            return "unexplained"
        seconds = [f.candidates[1].probability for f in self.findings if len(f.candidates) > 1]
        if any(p >= AMBIGUOUS for p in seconds):
            return "ambiguous"
        return "explained" if self.findings else "consistent"

    def answer(self) -> dict[str, Any]:
        """Return it as JSON knows it."""
        following = self.next_measurement
        return {
            "verdict": self.verdict,
            "summary": self.summary,
            "baseline": self.baseline.answer(),
            "findings": [f.answer() for f in self.findings],
            "final": self.final.answer(),
            "unexplained": None if self.unexplained is None else self.unexplained.answer(),
            "not_testable": [{"effect": n, "why": w} for n, w in self.not_testable.items()],
            "model_parameters": [p.answer() for p in self.model_parameters],
            "radiance_error": None if self.radiance is None else self.radiance.answer(),
            "next_measurement": following and following.answer(),
            "remarks": list(self.remarks),
        }
