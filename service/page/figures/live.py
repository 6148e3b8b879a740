"""The line that the camera sees now, and the lines that it saw before."""

from collections.abc import Sequence

import numpy as np

from service.owner.messages import Seen
from service.page.figures.plot import FIRST, Figure, figure, packed

_MOST_COLUMNS = 256
"""Of the waterfall, which travels whole twice a second."""


def profile(seen: Sequence[Seen]) -> Figure:
    """Mean code per column of the newest frame, DN."""
    if not seen:
        return figure([], x="column", y="mean of a frame / DN")
    newest = seen[-1]
    line = {
        "x": packed(newest.every * np.arange(newest.mean_dn.size)),
        "y": packed(newest.mean_dn),
        "mode": "lines",
        "line": {"color": FIRST, "width": 1.4},
        "name": newest.block,
    }
    return figure([line], x="column", y="mean of a frame / DN", uirevision=newest.run_id)


def waterfall(seen: Sequence[Seen]) -> Figure:
    """Mean code by frame and column, the newest frame on top, DN."""
    if not seen:
        return figure([], x="column", y="frames ago")
    step = -(-seen[-1].mean_dn.size // _MOST_COLUMNS)
    lines = np.stack([each.mean_dn[::step] for each in reversed(seen)])
    picture = {
        "type": "heatmap",
        "z": packed(lines),
        "x": packed(seen[-1].every * step * np.arange(lines.shape[1])),
        "y": packed(np.arange(len(lines))),
        "colorscale": "Cividis",
        "colorbar": {"title": {"text": "DN"}, "thickness": 12, "outlinewidth": 0},
    }
    made = figure([picture], x="column", y="frames ago", uirevision=seen[-1].run_id)
    made["layout"]["yaxis"]["autorange"] = "reversed"
    return made
