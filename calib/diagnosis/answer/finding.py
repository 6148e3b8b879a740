"""An effect that was found: what it may be called, where it lives, how much of it there is."""

from dataclasses import dataclass
from typing import Any

from calib.diagnosis.answer.absorbed import Absorbed
from calib.diagnosis.answer.estimate import Estimate
from calib.forward.departure import Departure


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
