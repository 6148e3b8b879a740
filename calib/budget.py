"""An uncertainty budget: who contributes how much, and what they come to together.

Source: JCGM 100:2008 (GUM), sections 4 (types A and B), 5 (law of propagation) and 6 (k = 2).
"""

import math
from dataclasses import dataclass
from typing import Literal

Distribution = Literal["normal", "student-t", "rectangular"]


@dataclass(frozen=True)
class BudgetRow:
    """One source of uncertainty.

    Attributes:
        quantity: What is uncertain.
        kind: "A" from the statistics of the data, "B" from elsewhere.
        distribution: What the standard uncertainty was derived from.
        value: Standard uncertainty of the quantity, in `unit`.
        unit: Unit of `value`.
        sensitivity: Derivative of the result by the quantity: result's unit per `unit`.
        scope: "common" where all columns share the error, "column" where the row is the typical
            (median) one of a single column.
        source: Where the value comes from, one phrase.
    """

    quantity: str
    kind: Literal["A", "B"]
    distribution: Distribution
    value: float
    unit: str
    sensitivity: float
    scope: Literal["common", "column"] = "common"
    source: str = ""

    @property
    def contribution(self) -> float:
        """Standard uncertainty that the row brings into the result, in the result's unit."""
        return abs(self.sensitivity) * self.value


@dataclass(frozen=True)
class Budget:
    """Rows that are independent of one another, for one result.

    Attributes:
        result: What the budget is of.
        unit: The result's unit; "1" for a relative uncertainty.
        rows: The contributions.
        coverage_factor: k of the expanded uncertainty.
    """

    result: str
    unit: str
    rows: tuple[BudgetRow, ...]
    coverage_factor: float = 2.0

    @property
    def combined(self) -> float:
        """Combined standard uncertainty: the root of the sum of squared contributions."""
        return math.sqrt(math.fsum(row.contribution**2 for row in self.rows))

    @property
    def combined_common(self) -> float:
        """The part that all columns share."""
        common = (row.contribution**2 for row in self.rows if row.scope == "common")
        return math.sqrt(math.fsum(common))

    @property
    def expanded(self) -> float:
        """Expanded uncertainty, `coverage_factor` times the combined one."""
        return self.coverage_factor * self.combined
