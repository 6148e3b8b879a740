"""Figures of a run: naming against sight, confusion, reliability, rates, held-out gains."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure

from calib.report.style import BLUE, GREEN, GREY, INK, ORANGE, house_style, new_figure
from tests.concealed.generator.catalogue import LISTED
from tests.concealed.scoring.confusion import confusion
from tests.concealed.scoring.intervals import Share
from tests.concealed.scoring.outcome import Outcome
from tests.concealed.scoring.rates import (
    CLEARLY_SEEN,
    REMAINDER,
    by_sigma,
    clearly,
    complete,
    covered,
    false_alarm,
    ideal_rate,
    named_first,
    of_kind,
    told_apart,
)
from tests.concealed.scoring.reliability import (
    expected_calibration_error,
    reliability_curve,
    statements,
)
from tests.concealed.scoring.summary import held_out_gains

_SIGMA = np.geomspace(0.4, 250.0, 200)
_FEW_BINS = (0.0, 2.0, 4.0, 7.0, 14.0, 40.0, np.inf)


def draw_all(every: Sequence[Outcome], folder: Path) -> None:
    """Write every figure of the run as PNG."""
    folder.mkdir(parents=True, exist_ok=True)
    with house_style():
        for name, figure in (
            ("naming", naming(every)),
            ("naming-each", naming_each(every)),
            ("confusion", confusion_matrix(every)),
            ("reliability", reliability(every)),
            ("rates", rates(every)),
            ("held-out", held_out(every)),
        ):
            figure.savefig(folder / f"{name}.png")


def naming(every: Sequence[Outcome]) -> Figure:
    """Draw how often an effect is named first, and covered, against the ideal filter's sight."""
    figure = new_figure(7.2, 3.8)
    axes = figure.subplots()
    single = of_kind(every, "single")
    _ideal(axes, "ideal filter, which knows the truth")
    for test, colour, label in (
        (named_first, BLUE, "named first"),
        (covered, ORANGE, "among 3 candidates or fewer"),
    ):
        _shares(axes, by_sigma(single, test), colour, label)
    foreign = of_kind(every, "foreign")
    if foreign:
        _shares(axes, by_sigma(foreign), GREEN, "unknown shapes named first")
    _sigma_axis(axes)
    axes.set(title="Single effects", ylabel="share of recordings")
    axes.legend(loc="lower right")
    return figure


def naming_each(every: Sequence[Outcome]) -> Figure:
    """Draw the same for each effect by itself."""
    figure = new_figure(9.6, 12.0)
    panels = figure.subplots(9, 4, sharex=True, sharey=True).ravel()
    single = of_kind(every, "single")
    for axes, name in zip(panels, LISTED, strict=False):
        mine = [one for one in single if one.truths[0].name == name]
        _ideal(axes, "ideal filter")
        _shares(axes, by_sigma(mine, bins=_FEW_BINS), BLUE, "named first")
        _sigma_axis(axes, label="")
        axes.set_title(name, fontsize=8.0)
    for axes in panels[len(LISTED) :]:
        axes.set_axis_off()
    handles, labels = panels[0].get_legend_handles_labels()
    panels[-1].legend(handles, labels, loc="center")
    figure.supxlabel("seen by the ideal filter, σ", fontsize=9.0)
    figure.supylabel("share named first", fontsize=9.0)
    return figure


def _ideal(axes: Axes, label: str) -> None:
    axes.plot(_SIGMA, [ideal_rate(z) for z in _SIGMA], color=GREY, lw=1.0, ls="--", label=label)


def _shares(axes: Axes, rows: Sequence[tuple[float, Share]], colour: str, label: str) -> None:
    x = [middle for middle, _ in rows]
    value = np.array([share.value for _, share in rows])
    below = value - [share.low for _, share in rows]
    above = np.array([share.high for _, share in rows]) - value
    axes.errorbar(x, value, np.abs([below, above]), fmt="o-", ms=3.5, color=colour, lw=1.0,
                  elinewidth=0.8, label=label)  # fmt: skip


def _sigma_axis(axes: Axes, label: str = "seen by the ideal filter, σ") -> None:
    axes.axvline(CLEARLY_SEEN, color=INK, lw=0.6, ls=":")
    axes.set(xscale="log", xlim=(0.4, 250.0), ylim=(-0.03, 1.03), xlabel=label)
    axes.set_xticks([1, 3, 10, 30, 100], labels=["1", "3", "10", "30", "100"])
    axes.minorticks_off()


def confusion_matrix(every: Sequence[Outcome]) -> Figure:
    """Draw which name was given for what was hidden, of cases that are clearly seen."""
    hidden, given, counts = confusion(clearly(every))
    total = counts.sum(axis=1, keepdims=True)
    share = np.divide(counts, total, out=np.zeros(counts.shape), where=total > 0)
    figure = new_figure(10.0, 10.6)
    axes = figure.subplots()
    paper = LinearSegmentedColormap.from_list("paper", ["#ffffff", BLUE])
    axes.imshow(share, cmap=paper, vmin=0.0, vmax=1.0, aspect="auto")
    for row, column in zip(*np.nonzero(counts), strict=True):
        axes.text(column, row, str(counts[row, column]), ha="center", va="center", fontsize=6.0,
                  color="white" if share[row, column] > 0.6 else INK)  # fmt: skip
    axes.axhline(len(LISTED) - 0.5, color=INK, lw=0.8)
    axes.axvline(len(LISTED) - 0.5, color=INK, lw=0.8)
    axes.set_xticks(range(len(given)), labels=given, rotation=90, fontsize=7.0)
    axes.set_yticks(range(len(hidden)), labels=hidden, fontsize=7.0)
    axes.grid(visible=False)
    axes.set(title=f"One effect, seen at {CLEARLY_SEEN:g} σ or more: what it was called",
             xlabel="first name given", ylabel="hidden")  # fmt: skip
    return figure


def reliability(every: Sequence[Outcome]) -> Figure:
    """Draw stated probabilities against how often they are kept, and their numbers."""
    stated = statements(every)
    curve = reliability_curve(stated)
    figure = new_figure(4.8, 5.4)
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=(3, 1))
    above.plot([0, 1], [0, 1], color=GREY, lw=0.8)
    _shares(above, [(one.stated, one.right) for one in curve], BLUE, "95 % interval")
    error = expected_calibration_error(curve)
    above.set(title=f"Probabilities (calibration error {error:.3f})",
              ylabel="share that was right", xlim=(0, 1), ylim=(-0.03, 1.03))  # fmt: skip
    below.hist(
        [probability for probability, _ in stated], bins=np.linspace(0, 1, 11).tolist(), color=BLUE
    )
    below.set(xlabel="stated probability", ylabel="candidates")
    return figure


def rates(every: Sequence[Outcome]) -> Figure:
    """Draw the rates of the claims with their intervals and aims."""
    unlisted = clearly(of_kind(every, "unlisted"), REMAINDER)
    rows = (
        ("clean: false alarms", Share.of(map(false_alarm, of_kind(every, "clean"))), 0.05),
        ("unlisted: wrong name", Share.of(bool(one.findings) for one in unlisted), 0.05),
        ("unlisted: unexplained", Share.of(one.unexplained for one in unlisted), 0.85),
        ("one: named first", Share.of(map(named_first, told_apart(of_kind(every, "single")))),
         0.95),
        ("unknown shape: named", Share.of(map(named_first, told_apart(of_kind(every, "foreign")))),
         0.85),
        ("two: both named", Share.of(map(complete, told_apart(of_kind(every, "double")))), 0.90),
        ("three: all named", Share.of(map(complete, told_apart(of_kind(every, "triple")))), 0.75),
    )  # fmt: skip
    figure = new_figure(7.2, 3.4)
    axes = figure.subplots()
    for place, (_, share, aim) in enumerate(reversed(rows)):
        if share.n:
            axes.plot([share.low, share.high], [place, place], color=BLUE, lw=1.2)
            axes.plot(share.value, place, "o", color=BLUE, ms=5)
        axes.plot([aim, aim], [place - 0.3, place + 0.3], color=ORANGE, lw=2.0)
    axes.plot([], [], "o-", color=BLUE, label="measured, 95 % interval")
    axes.plot([], [], color=ORANGE, lw=2.0, label="aim: at most (left), at least (right)")
    axes.set_yticks(range(len(rows)), labels=[f"{text} ({share.n})"
                                              for text, share, _ in reversed(rows)])  # fmt: skip
    axes.set(title="Rates", xlabel="share of recordings", xlim=(-0.02, 1.02))
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.2), ncols=2)
    return figure


def held_out(every: Sequence[Outcome]) -> Figure:
    """Draw which share of the explicable the rightly named findings explained, held out."""
    gains = held_out_gains(every)
    figure = new_figure(7.2, 3.0)
    axes = figure.subplots()
    axes.hist(np.clip(gains, -0.5, 1.2), bins=np.linspace(-0.5, 1.2, 35).tolist(), color=BLUE)
    if gains:
        median = float(np.median(gains))
        axes.axvline(median, color=ORANGE, label=f"median {median:.2f}")
        axes.legend(loc="upper left")
    axes.set(title="Held-out gain of the rightly named",
             xlabel="share of what the true model would gain", ylabel="findings")  # fmt: skip
    return figure
