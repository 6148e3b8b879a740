"""The run in numbers: one row per claim, one per effect."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import norm

from tests.concealed.generator.catalogue import LISTED
from tests.concealed.scoring.intervals import Share
from tests.concealed.scoring.outcome import Outcome
from tests.concealed.scoring.rates import (
    REMAINDER,
    clearly,
    complete,
    covered,
    false_alarm,
    half_named_sigma,
    ideal_threshold,
    named_first,
    of_kind,
    told_apart,
    wrongly_named,
)
from tests.concealed.scoring.reliability import (
    expected_calibration_error,
    reliability_curve,
    statements,
)
from tests.concealed.scoring.strengths import strength_z


@dataclass(frozen=True)
class Claim:
    """One line of what the proof shows; `reached` is None where nothing was measured."""

    text: str
    found: str
    aim: str
    reached: bool | None


def claims(every: Sequence[Outcome]) -> list[Claim]:
    """Return the claims in the order in which they are asked for."""
    single, foreign, two, three = (
        told_apart(of_kind(every, kind)) for kind in ("single", "foreign", "double", "triple")
    )
    unlisted = clearly(of_kind(every, "unlisted"), REMAINDER)
    clean = of_kind(every, "clean")
    return [
        _rate("named first, where clearly seen and told apart", map(named_first, single), 0.95),
        _rate(
            "candidates hold it, 3 or fewer, where clearly seen",
            map(covered, clearly(of_kind(every, "single"))),
            0.99,
        ),
        _rate("unknown shapes named first", map(named_first, foreign), 0.85),
        _rate("both of two named", map(complete, two), 0.90),
        _rate("all of three named", map(complete, three), 0.75),
        _rate("false alarms on clean recordings", map(false_alarm, clean), -0.05),
        _rate("unlisted called unexplained", (one.unexplained for one in unlisted), 0.85),
        _rate("unlisted given a wrong name", (bool(one.findings) for one in unlisted), -0.05),
        _rate("any wrong name, all cases", map(wrongly_named, every), None),
        _rate("diagnoses that failed", (bool(one.error) for one in every), -0.0),
        *_numbers(every),
    ]


def _numbers(every: Sequence[Outcome]) -> list[Claim]:
    stated = statements(every)
    curve = reliability_curve(stated)
    error = expected_calibration_error(curve)
    gains = held_out_gains(every)
    gain = float(np.median(gains)) if gains else float("nan")
    z = np.array([value for _, value in strength_z(every)])
    spread = float(np.sqrt(np.mean(z**2))) if len(z) else float("nan")
    return [
        Claim(f"expected calibration error of {len(stated)} candidates", f"{error:.3f}", "<= 0.03",
              error <= 0.03 if stated else None),
        Claim("bins of stated probability that are kept",
              f"{sum(one.kept for one in curve)} of {len(curve)}", "all",
              all(one.kept for one in curve) if curve else None),
        Claim(f"held-out gain of {len(gains)} rightly named over the true model's, median",
              f"{100 * gain:.1f} %", ">= 95 %", gain >= 0.95 if gains else None),
        Claim(f"root mean square z of {len(z)} parameters (as the nearer half scatter)",
              f"{spread:.2f} ({_middle(z):.2f})", "1 ± 0.15",
              abs(spread - 1.0) <= 0.15 if len(z) else None),
    ]  # fmt: skip


def _middle(z: NDArray[np.float64]) -> float:
    """Return the scatter that half of the errors show: a few far ones do not move it."""
    return float(np.median(np.abs(z))) / float(norm.ppf(0.75)) if len(z) else float("nan")


def held_out_gains(every: Sequence[Outcome]) -> list[float]:
    """Return, of rightly named findings, which share of what the true model gains was gained.

    The true model leaves chance alone: a deviance of one per number predicted, on average.
    """
    return [
        finding.fraction_explained
        for one in every
        for finding in one.findings
        if finding.name in one.hidden_names and finding.fraction_explained is not None
    ]


def _rate(text: str, each: Iterable[bool], aim: float | None) -> Claim:
    share = Share.of(each)
    if aim is None:
        return Claim(text, str(share), "-", None)
    most = str(aim).startswith("-")
    reached = (share.value <= -aim if most else share.value >= aim) if share.n else None
    return Claim(text, str(share), f"{'<=' if most else '>='} {100 * abs(aim):.0f} %", reached)


@dataclass(frozen=True)
class EffectRow:
    """One effect: how often it is named where clearly seen, and where half are named."""

    name: str
    named: Share
    covered: Share
    foreign: Share
    half_sigma: float
    not_testable: Share

    @property
    def half_ratio(self) -> float:
        """Sight at which half are named over the ideal filter's."""
        return self.half_sigma / ideal_threshold()


def effect_rows(every: Sequence[Outcome]) -> list[EffectRow]:
    """Return a row per listed effect."""
    return [_row(name, [one for one in every if _only(one, name)]) for name in LISTED]


def _row(name: str, mine: Sequence[Outcome]) -> EffectRow:
    single, foreign = of_kind(mine, "single"), of_kind(mine, "foreign")
    return EffectRow(
        name,
        Share.of(map(named_first, told_apart(single))),
        Share.of(map(covered, clearly(single))),
        Share.of(map(named_first, told_apart(foreign))),
        half_named_sigma(single) if single else float("nan"),
        Share.of(name in one.not_testable for one in mine),
    )


def _only(one: Outcome, name: str) -> bool:
    return len(one.truths) == 1 and one.truths[0].name == name


_EFFECT_HEAD = (
    "| effect | named first, seen at 7 σ, 5 σ apart | candidates hold it | unknown shapes "
    "| half named at, σ | by the ideal filter's |"
)


def as_markdown(every: Sequence[Outcome]) -> str:
    """Return both tables."""
    words = {True: "yes", False: "**no**", None: ""}
    lines = ["| claim | found | aim | reached |", "|---|---|---|---|"]
    lines += [f"| {c.text} | {c.found} | {c.aim} | {words[c.reached]} |" for c in claims(every)]
    lines += ["", _EFFECT_HEAD, "|---|---|---|---|---|---|"]
    for row in effect_rows(every):
        half = "-" if np.isnan(row.half_sigma) else f"{row.half_sigma:.1f}"
        ratio = "-" if np.isnan(row.half_sigma) else f"{row.half_ratio:.2f}"
        lines.append(f"| {row.name} | {row.named} | {row.covered} | {row.foreign} | {half} | "
                     f"{ratio} |")  # fmt: skip
    return "\n".join(lines) + "\n"
