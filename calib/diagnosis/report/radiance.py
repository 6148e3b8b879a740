"""What the plain calibration gets wrong of radiance, by signal."""

from matplotlib.axes import Axes

from calib.diagnosis.answer.radiance_error import RadianceError
from calib.diagnosis.report.panel import AFTER, BEFORE, Panel, on_axes

CAPTION = (
    "Error of the radiance by the plain calibration, if the fitted model is true, one point per "
    "flat: the middle of all pixels, and between which nine in ten lie. The blue band is what the "
    "amended calibration leaves unsure (twice the standard uncertainty of its parameters)."
)


def radiance_panel(found: RadianceError) -> Panel:
    """Return the figure."""

    def draw(axes: Axes) -> None:
        order = found.signal_dn.argsort()
        signal, error = found.signal_dn[order], 100.0 * found.error[order]
        spread = [error - 100.0 * found.low[order], 100.0 * found.high[order] - error]
        band = 200.0 * found.left_std[order]
        axes.fill_between(signal, -band, band, color=AFTER, alpha=0.3, lw=0)
        axes.axhline(0.0, color=AFTER, lw=1.2, label="amended calibration")
        axes.errorbar(
            signal, error, yerr=spread, fmt="o", ms=4, color=BEFORE, elinewidth=0.8,
            label="plain calibration",
        )  # fmt: skip
        axes.set(xlabel="signal, DN", ylabel="error of the radiance, %")
        axes.legend(loc="best")

    return Panel("radiance-error", on_axes(draw), (5.2, 2.9))
