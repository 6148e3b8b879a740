"""What a diagnosis says: frozen, with units, ready for JSON, a report and an amended model."""

from dataclasses import dataclass
from typing import Any

from calib.diagnosis.answer.empirical_term import EmpiricalTerm
from calib.diagnosis.answer.figures import Figures
from calib.diagnosis.answer.finding import Finding, Where
from calib.diagnosis.answer.next_measurement import NextMeasurement
from calib.diagnosis.answer.radiance_error import RadianceError
from calib.diagnosis.given.parameter_off import ParameterOff

AMBIGUOUS = 0.05
"""A second name that is so probable makes a finding ambiguous."""


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
