"""Draws the curves of one set, or of two."""

from nicegui import ui

from calib.radiometric.coefficients.coefficient_set import CoefficientSet
from service.page.figures.curves import CURVES, both, curve, difference

_BAND = "The band is two standard uncertainties wide on each side (k = 2)."


def draw_curves(shown: CoefficientSet) -> None:
    """Draw DN0, VE and QE of `shown`."""
    for what in CURVES:
        ui.plotly(curve(shown, what)).classes("df-figure-low").props(f'aria-label="{what.name}"')
    ui.label(_BAND).classes("df-note")


def draw_comparison(first: CoefficientSet, second: CoefficientSet) -> None:
    """Draw both over each other, and their difference; a sentence where they cannot be compared."""
    if first.n_columns != second.n_columns:
        ui.label(
            f"The sets have {first.n_columns} and {second.n_columns} columns;"
            " only sets of one region can be compared."
        ).classes("df-trouble")
        return
    with ui.element("div").classes("df-pairs"):
        for what in CURVES:
            for name, drawn in (
                (what.name, both(first, second, what)),
                (f"Difference in {what.name}", difference(first, second, what)),
            ):
                ui.plotly(drawn).classes("df-figure-low").props(f'aria-label="{name}"')
    ui.label(
        f"{_BAND} That of a difference takes the two sets as independent; what they share, such as"
        " a radiance standard, makes it wider than it is."
    ).classes("df-note")
