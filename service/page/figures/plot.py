"""How figures travel and look: arrays packed, colours readable on light and on dark."""

import base64
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike

Figure = dict[str, Any]
"""Data, layout and configuration, as Plotly's JavaScript takes them."""

FIRST: Final = "#1f77d0"
SECOND: Final = "#e07b00"
SOFT: Final = "#808a96"
"""All at least 3 : 1 against white and against the dark page (WCAG 2.2, 1.4.11)."""


def packed(values: ArrayLike) -> dict[str, str]:
    """Return numbers as Plotly reads them in base64: 4 bytes each, where JSON takes 20.

    Args:
        values: (n,) or (n, m); NaN is a gap.
    """
    array = np.ascontiguousarray(values, dtype="<f4")
    shape = {} if array.ndim == 1 else {"shape": ", ".join(map(str, array.shape))}
    return {"dtype": "f4", "bdata": base64.b64encode(array.tobytes()).decode(), **shape}


def figure(data: list[dict[str, Any]], *, x: str, y: str, **layout: Any) -> Figure:
    """Return a figure with titled axes, without a background of its own."""
    grid = {"gridcolor": "rgba(128,128,128,0.25)", "zeroline": False, "automargin": True}
    return {
        "data": data,
        "layout": {
            "paper_bgcolor": "rgba(0,0,0,0)",
            "plot_bgcolor": "rgba(0,0,0,0)",
            "font": {"family": "system-ui, sans-serif", "size": 12, "color": "#808080"},
            "margin": {"l": 60, "r": 12, "t": 26 if layout.get("showlegend") else 10, "b": 36},
            "xaxis": {"title": {"text": x, "standoff": 4}, **grid},
            "yaxis": {"title": {"text": y}, **grid},
            "legend": {
                "orientation": "h",
                "traceorder": "normal",
                "y": 1.0,
                "yanchor": "bottom",
                "x": 0,
            },
            "showlegend": False,
            "modebar": {"bgcolor": "rgba(0,0,0,0)"},
            **layout,
        },
        "config": {"displaylogo": False, "modeBarButtonsToRemove": ["lasso2d", "select2d"]},
    }


def banded(
    x: ArrayLike, y: ArrayLike, std: ArrayLike, *, name: str, color: str = FIRST
) -> list[dict[str, Any]]:
    """Return a line with its band of two standard uncertainties (k = 2), all (n,)."""
    at, value, half = np.asarray(x), np.asarray(y), 2.0 * np.asarray(std)
    edge = {"x": packed(at), "mode": "lines", "line": {"width": 0}, "hoverinfo": "skip"}
    return [
        {**edge, "y": packed(value - half), "showlegend": False},
        {
            **edge,
            "y": packed(value + half),
            "fill": "tonexty",
            "fillcolor": f"{color}44",
            "showlegend": False,
        },
        {
            "x": packed(at),
            "y": packed(value),
            "mode": "lines",
            "line": {"color": color, "width": 1.2},
            "name": name,
        },
    ]


def dots(
    x: ArrayLike, y: ArrayLike, std: ArrayLike, *, name: str, color: str = FIRST
) -> dict[str, Any]:
    """Return points with bars of two standard uncertainties (k = 2) to each side, all (n,)."""
    bars = {"array": packed(2.0 * np.asarray(std)), "thickness": 1.2, "width": 3, "color": color}
    return {
        "x": packed(x),
        "y": packed(y),
        "mode": "markers",
        "marker": {"color": color, "size": 7},
        "error_y": {"type": "data", **bars},
        "name": name,
    }


def straight(over: ArrayLike, offset: float, slope: float, *, name: str) -> dict[str, Any]:
    """Return a straight line from 0 to the largest of `over`."""
    ends = np.array([0.0, np.max(np.asarray(over))])
    line = {"color": SECOND, "width": 1.4}
    y = packed(offset + slope * ends)
    return {"x": packed(ends), "y": y, "mode": "lines", "line": line, "name": name}
