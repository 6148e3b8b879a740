"""What a diagnosis says: frozen, with units, ready for JSON, a report and an amended model."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

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
class Estimate:
    """A parameter: value, standard uncertainty, unit."""

    value: float
    std: float
    unit: str

    def answer(self) -> dict[str, Any]:
        """Return it as JSON knows it."""
        return {"value": self.value, "std": self.std, "unit": self.unit}


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
    """

    effect: Departure
    candidates: tuple[NamedCandidate, ...]
    significance_sigma: float
    where: Where
    parameters: dict[str, Estimate]
    heldout_before: float
    heldout_after: float
    fraction_explained: float

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
        }


@dataclass(frozen=True)
class Unexplained:
    """A remainder without a name."""

    significance_sigma: float
    where: Where

    def answer(self) -> dict[str, Any]:
        """Return it as JSON knows it."""
        return {"significance_sigma": self.significance_sigma, "where": self.where.answer()}


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
class Figures:
    """What a report draws.

    Attributes:
        residual_means: Of the plain model, whitened, (n_blocks, n_pixels).
        final_means: Of the final model, likewise.
        block_names: Of the blocks.
        looks: Each way of looking at the remainder, with its distance from chance.
        gains: What each effect alone would explain, by name.
    """

    residual_means: Floats
    final_means: Floats
    block_names: tuple[str, ...]
    looks: tuple[tuple[str, float], ...]
    gains: dict[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class ParameterOff:
    """A parameter of a given model that the recording contradicts."""

    name: str
    model: float
    fitted: float
    std: float
    unit: str

    def answer(self) -> dict[str, Any]:
        """Return it as JSON knows it."""
        return {
            "name": self.name,
            "model": self.model,
            "fitted": self.fitted,
            "std": self.std,
            "unit": self.unit,
        }


AMBIGUOUS = 0.05
"""A second name that is so probable makes a finding ambiguous."""


@dataclass(frozen=True)
class Diagnosis:
    """The answer."""

    baseline: Fit
    findings: tuple[Finding, ...]
    final: Fit
    unexplained: Unexplained | None
    not_testable: dict[str, str]
    model_parameters: tuple[ParameterOff, ...]
    figures: Figures

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
        return {
            "verdict": self.verdict,
            "baseline": self.baseline.answer(),
            "findings": [f.answer() for f in self.findings],
            "final": self.final.answer(),
            "unexplained": None if self.unexplained is None else self.unexplained.answer(),
            "not_testable": [{"effect": n, "why": w} for n, w in self.not_testable.items()],
            "model_parameters": [p.answer() for p in self.model_parameters],
            "next_measurement": None,
        }
