"""A coefficient of the plain fit that an effect had bent."""

from dataclasses import dataclass
from typing import Any

from calib.report.rounded import number

CLEAR_SIGMA = 3.0
"""A coefficient that is off by less, in standard uncertainties of the plain fit, hid nothing."""
NOTABLE = {"system gain": 0.01, "read noise": 0.02, "dark offset": 0.25, "response": 0.002}
"""Sizes of equal weight, relative but for the offset's, DN."""


@dataclass(frozen=True)
class Absorbed:
    """One coefficient of the plain fit that an effect had bent.

    Attributes:
        name: Which, as `NOTABLE` has it.
        plain, beside: Fitted alone, and beside the effects: mean over pixels or taps.
        difference: Plain less beside; relative but for the dark offset.
        std: Standard uncertainty of the plain fit, likewise.
        unit: Of the two values.
    """

    name: str
    plain: float
    beside: float
    difference: float
    std: float
    unit: str

    @property
    def weight(self) -> float:
        """Its size over a notable one; 0 where chance would do."""
        clear = abs(self.difference) > CLEAR_SIGMA * self.std
        return abs(self.difference) / NOTABLE[self.name] if clear else 0.0

    @property
    def text(self) -> str:
        """Return it in words: "a system gain 4.8 % too low"."""
        way = "high" if self.difference > 0 else "low"
        size, unit = abs(self.difference), "DN"
        if self.unit != "DN":
            size, unit = 100.0 * size, "%"
        # Its uncertainty is that of a coefficient, and two digits tell an operator enough.
        told = number(
            size, max(100.0 * self.std if unit == "%" else self.std, 0.1 * size), digits=1
        )
        return f"a {self.name} {told} {unit} too {way}"

    def answer(self) -> dict[str, Any]:
        """Return it as JSON knows it."""
        return {
            "coefficient": self.name, "plain": self.plain, "beside": self.beside,
            "difference": self.difference, "std": self.std, "unit": self.unit,
        }  # fmt: skip
