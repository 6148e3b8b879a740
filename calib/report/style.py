"""One look for every figure: few colours, thin lines, text that can be read at half size."""

import io
import re
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import matplotlib as mpl
from cycler import cycler
from matplotlib.figure import Figure

INK, BLUE, ORANGE, GREEN, GREY = "#20262e", "#1f5fa8", "#d2691e", "#3a7d44", "#9aa4af"
CYCLE = (BLUE, ORANGE, GREEN, "#7b4fa0", "#b8860b", "#008b8b")

# Any: the stubs know every setting's name by itself, but not that of a dictionary.
_SETTINGS: Any = {
    "font.family": "DejaVu Sans",
    "font.size": 9.0,
    "axes.titlesize": 10.0,
    "axes.titlelocation": "left",
    "axes.titleweight": "bold",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.edgecolor": INK,
    "axes.labelcolor": INK,
    "axes.linewidth": 0.8,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#e4e8ec",
    "grid.linewidth": 0.7,
    "text.color": INK,
    "xtick.color": INK,
    "ytick.color": INK,
    "lines.linewidth": 1.2,
    "legend.frameon": False,
    "legend.fontsize": 8.0,
    "axes.prop_cycle": cycler(color=CYCLE),
    "svg.hashsalt": "darkflat",  # the same figure gives the same bytes
    "svg.fonttype": "path",  # a memory stick carries no fonts
    "figure.dpi": 100.0,
    "savefig.dpi": 150.0,
}


@contextmanager
def house_style() -> Iterator[None]:
    """Draw in the house's style within."""
    with mpl.rc_context(_SETTINGS):
        yield


def new_figure(width_in: float = 7.2, height_in: float = 3.4) -> Figure:
    """Return an empty figure; no window, no global state."""
    return Figure(figsize=(width_in, height_in), layout="constrained")


def unit_text(unit: str) -> str:
    """Return a unit as it is set in print: "W m-2 sr-1" as "W m⁻² sr⁻¹"."""
    raised = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
    return re.sub(r"(?<=[A-Za-zµ])-?\d+", lambda power: power[0].translate(raised), unit)


def as_svg(figure: Figure) -> str:
    """Return the figure as an inline SVG element that scales with the page."""
    with mpl.rc_context(_SETTINGS):
        buffer = io.StringIO()
        figure.savefig(buffer, format="svg", metadata={"Date": None, "Creator": None})
    svg = buffer.getvalue()
    svg = svg[svg.index("<svg") :]
    return re.sub(r'(<svg [^>]*?)width="[^"]+" height="[^"]+"', r"\1", svg, count=1)
