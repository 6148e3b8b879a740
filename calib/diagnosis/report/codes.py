"""How often codes occur, and samples that stand out."""

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from calib.diagnosis.baseline.code_counts import CLASSES
from calib.diagnosis.report.compared import Compared
from calib.diagnosis.report.panel import AFTER, BEFORE, QUIET, RECORDED, Group, Panel, on_axes
from calib.diagnosis.statistics.rare import FLIPS, RARE, rare_trials

Floats = NDArray[np.float64]

WINDOW = 64
"""Codes that are drawn one by one."""
ENOUGH = 30.0
"""Codes of which fewer samples are expected are not drawn."""
_RARE_WORDS = (
    "above", "below", "tracks", "noisy pixels", "lines twice",
    "bit raised", "bit lowered",
)  # fmt: skip


def codes_group(seen: Compared, weight: float) -> Group:
    """Return the samples by code, and by its remainder after 16."""
    caption = (
        "Samples by code over what smooth noise would give, ± chance, where most samples are, and "
        "how often each remainder after 16 comes beyond that (orange: recorded; blue: left)."
    )
    panels = (
        Panel("codes-comb", on_axes(lambda axes: _comb(seen, axes)), (5.0, 2.6)),
        Panel("codes-classes", on_axes(lambda axes: _classes(seen, axes))),
    )
    return Group("codes", "Codes", caption, panels, weight)


def rare_group(seen: Compared, weight: float) -> Group:
    """Return how many samples, pixels and lines stand out in each block."""
    caption = (
        "Counts of what stands out, over all blocks: recorded, and expected with what was found."
    )
    panels = (Panel("rare", on_axes(lambda axes: _rare(seen, axes)), (5.0, 2.6)),)
    return Group("rare", "What stands out", caption, panels, weight)


def _window(expected: Floats) -> slice:
    """Return the stretch of codes in which most samples are expected."""
    total = np.cumsum(np.concatenate([[0.0], expected]))
    width = min(WINDOW, len(expected))
    first = int(np.argmax(total[width:] - total[:-width]))
    return slice(first, first + width)


def _comb(seen: Compared, axes: Axes) -> None:
    counts = seen.examined.evidence.code_counts
    part = _window(counts.expected)
    codes = np.arange(part.start, part.stop)
    expected, recorded = counts.expected[part], counts.observed[part]
    fine = expected > ENOUGH
    error = np.sqrt(1.0 / np.maximum(expected, 1.0))
    axes.fill_between(
        codes, 1 - 2 * error, 1 + 2 * error, where=fine, color=QUIET, alpha=0.3, lw=0, step="mid"
    )
    ratio = np.where(fine, recorded / np.maximum(expected, 1e-9), np.nan)
    axes.step(codes, ratio, where="mid", color=RECORDED, lw=1.0)
    axes.axhline(1.0, color=BEFORE, lw=0.9)
    axes.set(title="samples by code", xlabel="code, DN", ylabel="recorded over expected")


def _classes(seen: Compared, axes: Axes) -> None:
    counts, change = seen.examined.evidence.code_counts, seen.examined.model.change
    before = counts.whitened(seen.examined.model.observed.codes)[:CLASSES]
    x = np.arange(CLASSES)
    axes.bar(x - 0.2, before, 0.36, color=BEFORE)
    if change is not None:
        after = before - counts.whitened(change.codes)[:CLASSES]
        axes.bar(x + 0.2, after, 0.36, color=AFTER)
    axes.axhline(0.0, color=QUIET, lw=0.8)
    axes.set(title="the comb", xlabel="code modulo 16", ylabel="standard deviations")


def _rare(seen: Compared, axes: Axes) -> None:
    evidence, model = seen.examined.evidence, seen.examined.model
    trials = np.stack([rare_trials(n, evidence.sensor.n_pixels) for n in evidence.n])
    recorded = np.stack([each.events.counts(evidence.sensor.noisy) for each in evidence.sums]).sum(
        axis=0
    )
    x = np.arange(len(_RARE_WORDS))
    axes.bar(x - 0.2, _by_word(recorded), 0.36, color=RECORDED, label="recorded")
    if model.change is not None:
        expected = np.maximum((model.change.rare * trials).sum(axis=0), 0.0)
        axes.bar(x + 0.2, _by_word(expected), 0.36, color=AFTER, label="with what was found")
    axes.set_xticks(x, _RARE_WORDS, rotation=35.0, ha="right")
    axes.set_yscale("symlog", linthresh=1.0)
    top = 3.0 * max(float(recorded.max()), 1.0)
    axes.set(title="counts", ylabel="in all blocks", ylim=(0.0, top))
    axes.legend(loc="upper right")


def _by_word(counts: Floats) -> Floats:
    """Return counts, (n_rare,), with those of all bits together."""
    single = len(RARE) - 2 * FLIPS
    bits = counts[single:].reshape(2, FLIPS).sum(axis=1)
    return np.concatenate([counts[:single], bits])
