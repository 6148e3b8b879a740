"""All groups of panels of a report, those that show the most first."""

from functools import partial

from matplotlib.axes import Axes

from calib.diagnosis.answer.figures import Figures
from calib.diagnosis.report.codes import codes_group, rare_group
from calib.diagnosis.report.compared import Compared
from calib.diagnosis.report.lines import first_lines_group, rhythm_group
from calib.diagnosis.report.means import means_groups
from calib.diagnosis.report.neighbours import lines_group, neighbours_group
from calib.diagnosis.report.noise import noise_group
from calib.diagnosis.report.panel import AFTER, BEFORE, QUIET, Group, Panel, on_axes
from calib.kernels.residual_products import COLUMN_LAGS, LINE_LAGS

SHOWN_SHARE = 0.1
"""A group that shows this share of what the first one does is not folded away."""
MOST_SHOWN = 3
STATISTICS = {
    "mean": "means",
    "variance": "noise",
    "column_covariance": "columns",
    "line_covariance": "lines",
    "spectrum": "rhythm",
    "histogram": "codes",
    "tail": "rare",
    "transient": "onset",
}
"""The group in which each statistic of an answer is drawn."""


def groups_of_sums(figures: Figures) -> tuple[tuple[Group, ...], tuple[Group, ...]]:
    """Return what sums show: by how much each block's mean and variance miss, before and after."""

    def misses(statistic: int, axes: Axes) -> None:
        both = ((figures.residual_means, BEFORE), (figures.final_means, AFTER))
        for values, color in both:
            axes.plot(values[:, statistic], "o-", color=color, ms=3, lw=0.7)
        axes.axhline(0.0, color=QUIET, lw=0.8)
        axes.set(xlabel="block, as acquired", ylabel="standard deviations")
        axes.set_title(("means", "variances")[statistic])

    caption = "By how much each block misses the straight model, and that with what was found."
    panels = tuple(
        Panel(f"sums-{k}", on_axes(partial(misses, k)))
        for k in range(2)
        if figures.residual_means[:, k].any()
    )
    return ((Group("sums", "Sums of blocks", caption, panels, 1.0),), ())


def groups_of(seen: Compared) -> tuple[tuple[Group, ...], tuple[Group, ...]]:
    """Return the groups that matter, and the others, each in order of what it shows."""
    diagnosis = seen.examined.diagnosis
    places = [finding.where for finding in diagnosis.findings]
    if diagnosis.unexplained is not None:
        places = [diagnosis.unexplained.where, *places]
    follows = tuple(variable for where in places for variable in where.depends_on)
    groups = _weighed(seen, follows)
    named = {STATISTICS[where.statistic] for where in places}
    ranked = sorted(groups, key=lambda g: (g.name not in named, -g.weight))
    least = SHOWN_SHARE * max(g.weight for g in groups)
    shown = [g for k, g in enumerate(ranked) if k == 0 or g.name in named or g.weight > least]
    shown = shown[: max(MOST_SHOWN, len(named))]
    if not places:
        shown = [groups[0], groups[2]]
    return tuple(shown), tuple(g for g in ranked if g not in shown and g.panels)


def _weighed(seen: Compared, follows: tuple[str, ...]) -> list[Group]:
    """Return all groups with what they show; `follows` is what the findings follow."""
    energy = seen.energies()

    def weight(*kinds: str) -> float:
        """Return what these statistics show: explained, or still there."""
        return sum(max(before - after, after, 0.0) for before, after in (energy[k] for k in kinds))

    return [
        *means_groups(seen, follows, weight("mean", "steps")),
        noise_group(seen, weight("variance", "kurtosis")),
        neighbours_group(
            seen, weight(*(f"columns_{k + 1}" for k in range(COLUMN_LAGS)), "rows", "partners")
        ),
        lines_group(seen, weight(*(f"lines_{k + 1}" for k in range(LINE_LAGS)))),
        rhythm_group(seen, weight("common", "common_taps", "common_1", "common_2", "tones")),
        codes_group(seen, weight("codes")),
        first_lines_group(seen, weight("onset")),
        rare_group(seen, weight("rare")),
    ]
