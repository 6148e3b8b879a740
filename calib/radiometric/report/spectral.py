"""The spectral response and how it changes with the angle: AgCam's Fig. 2."""

from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from calib.errors import NotDeterminedError
from calib.radiometric.spectral.spectral_response import SpectralResponse
from calib.radiometric.spectral.spectral_response_angles import AngleComparison, angular_variation
from calib.radiometric.spectral.spectral_response_scan import SpectralScan
from calib.report.style import BLUE, GREY, new_figure


def spectral_response(scan: SpectralScan, angle_deg: float = 0.0) -> Figure:
    """Draw the response at one angle, and the others against it."""
    figure = new_figure(9.0, 3.6)
    others = angular_variation(scan, angle_deg)
    if not others:
        draw_response(figure.subplots(), scan.at_angle(angle_deg), angle_deg)
        return figure
    left, right = figure.subplots(1, 2, width_ratios=(1.7, 1))
    draw_response(left, scan.at_angle(angle_deg), angle_deg)
    draw_shifts(right, others)
    return figure


def draw_response(axes: Axes, response: SpectralResponse, angle_deg: float) -> None:
    """Show the response with its uncertainty and the figures that describe the band."""
    nm = response.wavelength_nm
    low, high = response.response - 2 * response.std, response.response + 2 * response.std
    axes.fill_between(nm, low, high, color=BLUE, alpha=0.25, linewidth=0, label="± 2 std")
    label = f"response at {angle_deg:g}°"
    axes.plot(nm, response.response, color=BLUE, marker=".", markersize=3, label=label)
    _mark_width(axes, response)
    axes.set(title="Relative spectral response", xlabel="wavelength (nm)", ylim=(-0.05, 1.3))
    axes.legend(loc="upper left", ncols=3, columnspacing=1.0)


def draw_shifts(axes: Axes, angles: Sequence[AngleComparison]) -> None:
    """Show how far the band's centroid moves with the angle of incidence."""
    x = [angle.angle_deg for angle in angles]
    y = [angle.centroid_shift_nm.value for angle in angles]
    axes.errorbar(x, y, [2 * a.centroid_shift_nm.std for a in angles], fmt="o", capsize=3)
    for angle in angles:
        axes.annotate(
            f"{angle.significance_sigma:+.1f} σ", (angle.angle_deg, angle.centroid_shift_nm.value),
            xytext=(6, 8), textcoords="offset points", color=GREY, fontsize=8,
        )  # fmt: skip
    axes.axhline(0, color=GREY, linewidth=0.7)
    axes.set(
        title="Shift of the centroid, ± 2 std",
        xlabel="angle of incidence (°)\nσ: significance of the change in shape",
        ylabel="nm",
    )
    axes.margins(x=0.3)


def _mark_width(axes: Axes, response: SpectralResponse) -> None:
    """Write FWHM and what is out of band into the figure, as far as they are determined."""
    try:
        (left, right), width = response.half_maximum_nm, response.fwhm_nm
    except NotDeterminedError:
        return
    axes.annotate("", (left, 0.5), (right, 0.5), arrowprops={"arrowstyle": "<->", "color": GREY})
    text = f"FWHM {width.value:.1f} ± {width.std:.1f} nm"
    leak = response.out_of_band_fraction
    if leak is not None:
        text += f"\nout of band {100 * leak.value:.2f} ± {100 * leak.std:.2f} %"
    axes.text((left + right) / 2, 0.52, text, ha="center", va="bottom")
