"""A number of a given model that a recording contradicts."""

from dataclasses import dataclass
from typing import Any


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
