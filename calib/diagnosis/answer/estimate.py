"""A fitted number."""

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Estimate:
    """A parameter: value, standard uncertainty, unit."""

    value: float
    std: float
    unit: str

    def answer(self) -> dict[str, Any]:
        """Return it as JSON knows it."""
        return {"value": self.value, "std": self.std, "unit": self.unit}
