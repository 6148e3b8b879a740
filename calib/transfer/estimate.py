"""A number, how sure it is, and what it counts."""

import math
from dataclasses import dataclass
from typing import Any, Self


@dataclass(frozen=True)
class Estimate:
    """One figure of merit.

    Attributes:
        value: NaN where it is not determined.
        std: Standard uncertainty (k = 1); NaN where not determined.
        unit: Of both; "1" for a ratio.
        reason: Why it is not determined, one sentence; "" where it is.

    >>> Estimate(0.25, 0.01, "DN/e-").answer()
    {'value': 0.25, 'std': 0.01, 'unit': 'DN/e-'}
    >>> Estimate.unknown("1", "no photons are stated").answer()
    {'value': None, 'std': None, 'unit': '1', 'reason': 'no photons are stated'}
    """

    value: float
    std: float
    unit: str
    reason: str = ""

    @classmethod
    def unknown(cls, unit: str, reason: str) -> Self:
        """Return what is not determined, and why."""
        return cls(math.nan, math.nan, unit, reason)

    @property
    def is_known(self) -> bool:
        """Whether there is a value."""
        return math.isfinite(self.value)

    def answer(self) -> dict[str, Any]:
        """Return it as JSON has it: an unknown number is None, with the reason."""
        told: dict[str, Any] = {
            "value": self.value if math.isfinite(self.value) else None,
            "std": self.std if math.isfinite(self.std) else None,
            "unit": self.unit,
        }
        return {**told, "reason": self.reason} if self.reason else told
