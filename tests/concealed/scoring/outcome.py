"""A finished case: what was hidden beside what was said."""

import json
import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from tests.concealed.generator.answer import Answer
from tests.concealed.generator.seal import opened
from tests.concealed.scoring.run import finished
from tests.concealed.scoring.visibility import NOT_KNOWN, Visibility, Visible


@dataclass(frozen=True)
class Truth:
    """One hidden effect.

    Attributes:
        sigma: What a filter that knows it would see, standard deviations.
        apart: How far the nearest other name is, standard deviations; `nearest` says which.
    """

    name: str
    listed: bool
    known_shape: bool
    rung: float
    sigma: float
    apart: float = math.inf
    nearest: str = ""


@dataclass(frozen=True)
class Finding:
    """One finding; `candidates` in the order of their probabilities, the first is the name."""

    name: str
    probability: float
    candidates: tuple[tuple[str, float], ...]
    fraction_explained: float | None = None

    @property
    def names(self) -> frozenset[str]:
        """All candidates."""
        return frozenset({self.name, *(name for name, _ in self.candidates)})


@dataclass(frozen=True)
class Outcome:
    """A case with its truths and what the diagnosis made of it."""

    number: int
    kind: str
    truths: tuple[Truth, ...]
    verdict: str
    findings: tuple[Finding, ...]
    unexplained: bool
    not_testable: frozenset[str] = frozenset()
    seconds: float = 0.0
    error: str = ""
    parameters: tuple[dict[str, Any], ...] = field(default=(), repr=False)
    answer: Answer | None = field(default=None, repr=False, compare=False)

    @property
    def first(self) -> str:
        """The first name, "unexplained" where there is none but something was seen, or "none"."""
        if self.findings:
            return self.findings[0].name
        return "unexplained" if self.unexplained else "none"

    @property
    def hidden_names(self) -> frozenset[str]:
        """What was hidden."""
        return frozenset(truth.name for truth in self.truths)


def outcomes(out: Path, visible: Visible) -> Iterator[Outcome]:
    """Open the answers of a run and yield its finished cases.

    ValueError where an answer is not the one that was committed to before the diagnosis.
    """
    key = bytes.fromhex((out / "key.hex").read_text("utf-8"))
    committed = _committed(out)
    for number, line in sorted(finished(out).items()):
        content = (out / "answers" / f"{number:05d}.sealed").read_bytes()
        if content[:32].hex() not in committed[number] or content[:32].hex() != line["sha256"]:
            raise ValueError(f"case {number}: its answer is not the one that was committed to")
        yield outcome(line, opened(content, key), visible.get(number, ()))


def outcome(line: dict[str, Any], answer: Answer, visible: tuple[Visibility, ...]) -> Outcome:
    """Return one case's outcome from its line and its opened answer."""
    said = line.get("said", {})
    effects = answer.told["effects"]
    truths = tuple(
        Truth(one["name"], one["listed"], one["known_shape"], one["rung"], *seen)
        for one, seen in zip(effects, visible or [NOT_KNOWN] * len(effects), strict=True)
    )
    return Outcome(
        answer.told["number"],
        answer.told["kind"],
        truths,
        said.get("verdict", "error"),
        tuple(_finding(one) for one in said.get("findings", ())),
        said.get("unexplained") is not None,
        frozenset(one["effect"] for one in said.get("not_testable", ())),
        line["seconds"],
        line.get("error", ""),
        tuple(one.get("parameters", {}) for one in said.get("findings", ())),
        answer,
    )


def _committed(out: Path) -> dict[int, set[str]]:
    known: dict[int, set[str]] = {}
    for text in (out / "commitments.jsonl").read_text("utf-8").splitlines():
        line = json.loads(text)
        known.setdefault(line["number"], set()).add(line["sha256"])
    return known


def _finding(said: dict[str, Any]) -> Finding:
    candidates = sorted(
        ((one["effect"], float(one["probability"])) for one in said.get("candidates", ())),
        key=lambda pair: -pair[1],
    )
    return Finding(
        said["effect"], float(said["probability"]), tuple(candidates),
        said.get("fraction_explained"),
    )  # fmt: skip
