"""The next measurement, as the answer of a diagnosis holds it."""

from dataclasses import dataclass
from typing import Any

import tomli_w


@dataclass(frozen=True)
class NextMeasurement:
    """A plan, what it is for, and what it is expected to reach.

    Attributes:
        why: One sentence.
        plan: As `darkflat sweep` runs it.
        expected_sigma: The separation of the closest two names with it; None where it is to make
            effects testable.
        recorded_sigma: The same of what is recorded already.
        seconds: It takes on the bench.
        reached: Whether the separation that was asked for is expected.
        makes_testable: Names of effects that could be seen then.
    """

    why: str
    plan: dict[str, Any]
    expected_sigma: float | None
    recorded_sigma: float | None
    seconds: float
    reached: bool
    makes_testable: tuple[str, ...] = ()

    @property
    def plan_toml(self) -> str:
        """The plan as a file."""
        return tomli_w.dumps(self.plan)

    def answer(self) -> dict[str, Any]:
        """Return it as JSON knows it."""
        return {
            "why": self.why,
            "plan": self.plan,
            "plan_toml": self.plan_toml,
            "expected_sigma": self.expected_sigma,
            "recorded_sigma": self.recorded_sigma,
            "seconds": self.seconds,
            "reached": self.reached,
            "makes_testable": list(self.makes_testable),
        }
