"""What a recording's own data say about whether it may be used."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, Literal

from calib.errors import NotDeterminedError

Severity = Literal["warning", "refusal"]


@dataclass(frozen=True)
class Finding:
    """One precondition that does not hold.

    Attributes:
        code: In kebab-case, for scripts.
        text: One sentence: what, where, what to do.
        figure: The number that it rests on, as the text has it.
        severity: Whether the recording is used in spite of it.
    """

    code: str
    text: str
    figure: float
    severity: Severity = "warning"

    def answer(self) -> dict[str, Any]:
        """Return it as JSON has it."""
        return {
            "code": self.code,
            "text": self.text,
            "figure": self.figure,
            "severity": self.severity,
        }


def checked(findings: Iterable[Finding]) -> tuple[Finding, ...]:
    """Return the warnings; NotDeterminedError with the code of the first refusal, if any."""
    every = tuple(findings)
    for finding in every:
        if finding.severity == "refusal":
            raise NotDeterminedError(finding.text, code=finding.code)
    return every
