"""Which order of the vignette's polynomial predicts columns that the fit did not see."""

from matplotlib.figure import Figure

from calib.radiometric.estimation.order_choice import OrderChoice
from calib.report.style import BLUE, GREY, new_figure


def order_choice(choice: OrderChoice) -> Figure:
    """Draw the prediction error by order beside the paper's residual."""
    figure = new_figure(height_in=3.0)
    axes = figure.subplots()
    axes.plot(
        choice.orders,
        [100 * e for e in choice.residual_std],
        "s--",
        color=GREY,
        label=f"residual (AgCam's choice: {choice.by_residual})",
    )
    axes.plot(
        choice.orders,
        [100 * e for e in choice.held_out_rms],
        "o-",
        color=BLUE,
        label=f"held-out columns (chosen: {choice.chosen})",
    )
    axes.axvline(choice.chosen, color=BLUE, lw=0.8, ls=":")
    axes.set(title="Order of the vignette's polynomial", xlabel="order", ylabel="error, %")
    axes.legend(loc="upper right")
    return figure
