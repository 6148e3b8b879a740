"""What a correction does to a block: profiles over the columns and images, before and after."""

from typing import Any, Final

import numpy as np

from calib.arrays import Columns, Lines, RawLines
from service.evaluation.corrected_block import CorrectedBlock
from service.page.figures.plot import FIRST, SECOND, SOFT, Figure, banded, figure, packed

_MOST_LINES: Final = 64
_MOST_COLUMNS: Final = 512
"""Of an image; a screen shows no more, and each number travels."""
_SPAN: Final = 3.0
"""Images reach so many of the raw lines' standard deviations to both sides, both by the same."""


def unevenness(shown: CorrectedBlock) -> Figure:
    """By how much the mean line's columns are off their mean, as codes and as radiance, percent."""
    traces = [
        _line(100.0 * (mean / np.mean(mean[shown.used]) - 1.0), name=name, color=color)
        for mean, name, color in (
            (_of_used(shown, shown.raw_dn), "before: DN", SECOND),
            (_of_used(shown, shown.radiance), "after: radiance", FIRST),
        )
    ]
    return figure(traces, x="column", y="off the mean / %", showlegend=True)


def raw_profile(shown: CorrectedBlock) -> Figure:
    """One raw line and the mean of all, DN."""
    mean = _line(shown.raw_dn.mean(axis=0), name=_of_all(shown), color=SECOND)
    return _profile([_single(shown.raw_dn), mean], "DN")


def radiance_profile(shown: CorrectedBlock, unit: str) -> Figure:
    """One line's radiance and the mean of all with its uncertainty (k = 2), in `unit`."""
    mean = _of_used(shown, shown.radiance)
    columns = np.arange(mean.size)
    lines = banded(columns, mean, shown.mean_std, name=_of_all(shown))
    return _profile([_single(shown.radiance), *lines], f"radiance / {unit}")


def raw_image(shown: CorrectedBlock) -> Figure:
    """The first lines, DN."""
    return _image(shown.raw_dn, shown.before.single_line, "DN")


def radiance_image(shown: CorrectedBlock, unit: str) -> Figure:
    """The same lines as radiance, in `unit`; masked columns are blank."""
    return _image(shown.radiance, shown.before.single_line, unit)


def _of_used(shown: CorrectedBlock, lines: Lines | RawLines) -> Columns:
    return np.where(shown.used, lines.mean(axis=0, dtype=np.float64), np.nan)


def _of_all(shown: CorrectedBlock) -> str:
    return f"mean of {len(shown.raw_dn)}"


def _single(lines: Lines | RawLines) -> dict[str, Any]:
    return _line(lines[0], name="one line", color=SOFT, width=0.7)


def _line(y: Lines | RawLines, *, name: str, color: str, width: float = 1.4) -> dict[str, Any]:
    at = packed(np.arange(y.size))
    style = {"color": color, "width": width}
    return {"x": at, "y": packed(y), "mode": "lines", "line": style, "name": name}


def _profile(traces: list[dict[str, Any]], y: str) -> Figure:
    return figure(traces, x="column", y=y, showlegend=True)


def _image(lines: Lines | RawLines, variation_percent: float, unit: str) -> Figure:
    step = -(-lines.shape[1] // _MOST_COLUMNS)
    seen = lines[:_MOST_LINES, ::step].astype(np.float64)
    middle = float(np.nanmedian(seen))
    half = _SPAN * variation_percent / 100.0 * abs(middle)
    picture = {
        "type": "heatmap",
        "z": packed(seen),
        "x": packed(step * np.arange(seen.shape[1])),
        "y": packed(np.arange(len(seen))),
        "colorscale": "Greys",
        "zmin": middle - half,
        "zmax": middle + half,
        "colorbar": {"title": {"text": unit}, "thickness": 12, "outlinewidth": 0},
    }
    made = figure([picture], x="column", y="line")
    made["layout"]["yaxis"]["autorange"] = "reversed"
    return made
