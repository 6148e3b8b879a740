"""A panel: one small figure that says one thing, narrow enough for a phone."""

from collections.abc import Callable
from dataclasses import dataclass

from matplotlib.axes import Axes
from matplotlib.figure import Figure, FigureBase

from calib.report.style import BLUE, GREY, INK, ORANGE, as_svg, house_style, new_figure

BEFORE, AFTER, RECORDED = ORANGE, BLUE, INK
"""Colours, the same in every panel: plain model, with what was found, as recorded."""
QUIET = GREY
NARROW = (3.6, 2.55)


@dataclass(frozen=True)
class Panel:
    """A small figure.

    Attributes:
        name: Of a file, in the gallery.
        draw: Draws it.
        size: Width and height, inches.
    """

    name: str
    draw: Callable[[FigureBase], None]
    size: tuple[float, float] = NARROW

    def figure(self) -> Figure:
        """Return the figure; in the house's style, if within it."""
        figure = new_figure(*self.size)
        self.draw(figure)
        return figure

    def svg(self) -> str:
        """Return it as an inline SVG element."""
        with house_style():
            return as_svg(self.figure())


@dataclass(frozen=True)
class Group:
    """Panels of one statistic.

    Attributes:
        name: Of the group.
        title: In words.
        caption: What to see in it.
        panels: The small figures.
        weight: How much it shows: deviance that was or is there beyond chance.
    """

    name: str
    title: str
    caption: str
    panels: tuple[Panel, ...]
    weight: float


def on_axes(draw: Callable[[Axes], None]) -> Callable[[FigureBase], None]:
    """Return what draws on a figure's only axes."""

    def drawn(figure: FigureBase) -> None:
        draw(figure.subplots())

    return drawn
