"""What no effect explains: how it runs over blocks and columns, and in what it shows."""

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from calib.diagnosis.answer.empirical_term import EmpiricalTerm
from calib.diagnosis.naming.remainder import CERTAIN_SIGMA
from calib.diagnosis.report.compared import Compared
from calib.diagnosis.report.means import binned, by_column
from calib.diagnosis.report.panel import AFTER, BEFORE, QUIET, Panel, on_axes
from calib.diagnosis.words.verdict import spoken

Floats = NDArray[np.float64]


def remainder_panels(seen: Compared) -> tuple[Panel, ...]:
    """Return how far from chance each look is, and the strongest pattern of the means."""
    by_block, along = strongest_pattern(seen)
    names = seen.examined.evidence.table.names

    def blocks(axes: Axes) -> None:
        axes.axhline(0.0, color=QUIET, lw=0.8)
        axes.plot(np.arange(len(names)), by_block, "o-", color=AFTER, ms=3.5, lw=0.8)
        axes.set(title="over the blocks", xlabel="block, as acquired", ylabel="pattern, σ")

    def columns(axes: Axes) -> None:
        axes.axhline(0.0, color=QUIET, lw=0.8)
        pooled, x = binned(along[None])
        axes.plot(x, pooled[0], color=AFTER)
        axes.set(title="along the columns", xlabel="column", ylabel="pattern, σ")

    return (
        Panel("remainder-looks", on_axes(lambda axes: _looks(seen, axes))),
        Panel("remainder-blocks", on_axes(blocks)),
        Panel("remainder-columns", on_axes(columns)),
    )


def term_panel(term: EmpiricalTerm) -> Panel:
    """Return the empirical term with its uncertainty."""

    def draw(axes: Axes) -> None:
        at, add = np.array(term.effect.at), np.array(term.effect.add_dn)
        axes.errorbar(at, add, yerr=term.std_dn, fmt="o-", ms=3.5, color=AFTER, capsize=2)
        axes.axhline(0.0, color=QUIET, lw=0.8)
        axes.set(title="empirical term", xlabel=term.effect.follows, ylabel="DN")

    return Panel("empirical-term", on_axes(draw))


def strongest_pattern(seen: Compared) -> tuple[Floats, Floats]:
    """Return the first singular vectors of the means' remainder, by block and column, in σ."""
    plane = by_column(seen, seen.whitened_after)
    left, size, right = np.linalg.svd(plane, full_matrices=False)
    sign = 1.0 if right[0].sum() >= 0 else -1.0
    return sign * left[:, 0] * size[0], sign * right[0] * size[0]


def remainder_words(seen: Compared) -> tuple[str, ...]:
    """Return in which statistics it is beyond chance; `where` says what it follows."""
    words = []
    looks = _by_statistic(seen)
    seen_in = [f"{spoken(name)} ({sigma:.0f} σ)" for name, sigma in looks if sigma > CERTAIN_SIGMA]
    if seen_in:
        words.append(f"It is beyond chance in: {', '.join(seen_in)}.")
    return tuple(words)


def _by_statistic(seen: Compared) -> list[tuple[str, float]]:
    best: dict[str, float] = {}
    for name, sigma in seen.examined.diagnosis.figures.looks:
        best[name] = max(best.get(name, 0.0), sigma)
    return sorted(best.items(), key=lambda pair: -pair[1])


def _looks(seen: Compared, axes: Axes) -> None:
    looks = _by_statistic(seen)[::-1]
    names = [spoken(name) for name, _ in looks]
    sigma = np.array([s for _, s in looks])
    colors = [BEFORE if s > CERTAIN_SIGMA else QUIET for s in sigma]
    axes.barh(np.arange(len(looks)), sigma, color=colors)
    axes.axvline(CERTAIN_SIGMA, color=QUIET, lw=0.8, ls="--")
    axes.set_yticks(np.arange(len(looks)), names, fontsize=8)
    axes.set(title="how far from chance", xlabel="standard deviations")
