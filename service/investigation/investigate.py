"""The loop: record, diagnose all that was recorded, ask what to measure next, and again."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

from calib.diagnosis.answer.diagnosis import Diagnosis
from calib.diagnosis.deciding.bench import BenchTime
from calib.diagnosis.deciding.decide import next_measurement
from calib.diagnosis.deciding.rivals import is_open
from calib.diagnosis.diagnose import Examination, diagnose
from calib.diagnosis.recorded.joint import joint
from calib.recording.open import open_recording
from service.plan.model import Plan

Outcome = Literal["decided", "undecidable", "budget-spent"]
Take = Callable[[Plan, Path], None]
"""Runs a plan into a recording; raises where it did not succeed."""
Tell = Callable[[float, str], None]
"""Takes which share of the diagnosis is done, and what goes on."""

MOST_SWEEPS = 5


@dataclass(frozen=True)
class Round:
    """One sweep and what was known after it.

    Attributes:
        plan: Of the sweep.
        recording: Of it.
        diagnosis: Of all recordings so far, with what to measure next.
        seconds: Since the investigation began.
    """

    plan: Plan
    recording: Path
    diagnosis: Diagnosis
    seconds: float

    def answer(self) -> dict[str, Any]:
        """Return it as JSON knows it."""
        following = self.diagnosis.next_measurement
        return {
            "plan": self.plan.name,
            "recording": str(self.recording),
            "verdict": self.diagnosis.verdict,
            "names": [[c.effect for c in f.candidates] for f in self.diagnosis.findings],
            "next": following and following.why,
            "expected_sigma": following and following.expected_sigma,
            "seconds": self.seconds,
        }


@dataclass(frozen=True)
class Investigation:
    """How it ended.

    Attributes:
        outcome: `decided`: no finding has a second name; `undecidable`: none of the plans tells;
            `budget-spent`: the next sweep would end too late, or would be one too many.
        rounds: The sweeps.
        examined: All recordings together.
    """

    outcome: Outcome
    rounds: tuple[Round, ...]
    examined: Examination

    def answer(self) -> dict[str, Any]:
        """Return it as JSON knows it."""
        return {
            "outcome": self.outcome,
            "rounds": [each.answer() for each in self.rounds],
            "diagnosis": self.examined.diagnosis.answer(),
        }


def investigate(
    take: Take,
    bench: BenchTime,
    first: Plan,
    out: Path,
    *,
    budget_s: float = float("inf"),
    tell: Tell = lambda _share, _doing: None,
) -> Investigation:
    """Measure until every finding has one name, no plan would give it, or time is up.

    Args:
        take: Runs a plan.
        bench: What can be measured, and what that costs.
        first: The first sweep; what is no sweep of it holds for the later ones, too.
        out: A folder that is there; sweep N becomes `N.h5`, its plan `N.toml`.
        budget_s: Wall time. No sweep begins that would end after it; the first always does.
        tell: Told what goes on while nothing is recorded.

    Raises:
        DarkflatError: What sweeps and diagnoses raise; what was recorded stays.
    """
    began, plan, rounds = time.monotonic(), first, list[Round]()
    while True:
        recording = out / f"{len(rounds) + 1}.h5"
        recording.with_suffix(".toml").write_text(plan.dumps(), encoding="utf-8")
        take(plan, recording)
        left_s = budget_s - (time.monotonic() - began)
        paths = [*(each.recording for each in rounds), recording]
        examined = _examined(paths, bench, left_s, tell)
        seconds = time.monotonic() - began
        rounds.append(Round(plan, recording, examined.diagnosis, seconds))
        outcome = _outcome(examined.diagnosis, len(rounds), budget_s - seconds)
        if outcome is not None:
            return Investigation(outcome, tuple(rounds), examined)
        plan = _following(first, examined.diagnosis)


def _examined(paths: Sequence[Path], bench: BenchTime, left_s: float, tell: Tell) -> Examination:
    """Return the diagnosis of all recordings with what to measure next, if that is asked for."""
    recordings = [open_recording(path) for path in paths]
    doing = f"diagnosing {len(paths)} sweeps" if len(paths) > 1 else "diagnosing the first sweep"
    examined = diagnose(recordings, progress=lambda share: tell(0.7 * share, doing))
    if not any(is_open(finding) for finding in examined.diagnosis.findings):
        return examined
    tell(0.7, "looking for the deciding sweep")
    header = joint([each.header for each in recordings]).header
    following = next_measurement(examined, header, bench, most_s=max(left_s, 0.0))
    return replace(examined, diagnosis=replace(examined.diagnosis, next_measurement=following))


def _outcome(diagnosis: Diagnosis, sweeps: int, left_s: float) -> Outcome | None:
    if not any(is_open(finding) for finding in diagnosis.findings):
        return "decided"
    if left_s <= 0 or sweeps >= MOST_SWEEPS:
        return "budget-spent"
    following = diagnosis.next_measurement
    if following is None or (following.expected_sigma or 0.0) < 1.0:
        return "undecidable"
    return "budget-spent" if following.seconds > left_s else None


def _following(first: Plan, diagnosis: Diagnosis) -> Plan:
    """Return the plan of the next measurement, settled and guarded as the first one was."""
    following = diagnosis.next_measurement
    assert following is not None  # noqa: S101 - it was asked for
    kept = first.model_dump(mode="json", exclude_none=True)
    taken = {name: following.plan[name] for name in ("name", "lines", "sweep")}
    dropped = ("frame_lines", "repeats", "order", "darks")
    return Plan.parse({**{k: v for k, v in kept.items() if k not in dropped}, **taken})
