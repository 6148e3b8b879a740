"""The transfer function, its uncertainty and the PSF in two dimensions."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from calib.mtf.figures_of_merit import PER_MM
from calib.mtf.result import TransferResult
from calib.report.style import INK, new_figure

_FREQUENCY = {"xlabel": "fx, along columns (1/mm)", "ylabel": "fy, along rows (1/mm)"}


def transfer_map(result: TransferResult) -> Figure:
    """Draw the real part, with its signs, and the imaginary part, which an asymmetry makes."""
    figure = new_figure(9.0, 4.1)
    left, right = figure.subplots(1, 2)
    values = result.values
    for axes, part, name in (
        (left, values.transfer.real, "Transfer function, real part"),
        (right, values.transfer.imag, "imaginary part"),
    ):
        size = 1.0 if axes is left else max(float(np.abs(part[values.valid]).max()), 1e-3)
        shown = np.where(values.valid, part, np.nan)
        _show(figure, axes, result, shown, name, cmap="RdBu_r", vmin=-size, vmax=size)
        if axes is left:
            axis = PER_MM * result.measurement.frequency_per_um
            axes.contour(axis, axis, shown, levels=[0.0], colors=INK, linewidths=0.7)
    return figure


def noise_map(result: TransferResult) -> Figure:
    """Draw the standard uncertainty, and which harmonics it comes from."""
    figure = new_figure(9.0, 4.1)
    left, right = figure.subplots(1, 2)
    values = result.values
    shown = np.where(values.valid, values.std, np.nan)
    _show(figure, left, result, np.log10(shown), "Standard uncertainty, log₁₀", cmap="viridis")
    covariance = np.diag(result.measurement.fit.transfer_covariance)
    std = np.sqrt(covariance[: len(covariance) // 2] + covariance[len(covariance) // 2 :])
    radius = PER_MM * np.hypot(*result.measurement.fit.detector_per_um.T)
    axis = PER_MM * result.measurement.frequency_per_um
    distance = np.hypot(*np.meshgrid(axis, axis))
    label = {"regularised": "between them, on the grid", "filter": "filtered, on the grid"}
    method = label[result.measurement.method]
    right.semilogy(distance[values.valid], values.std[values.valid], ".", ms=2, label=method)
    right.semilogy(radius, std, "o", ms=3, label="single harmonics")
    right.set(title="by frequency", xlabel="|f| (1/mm)", ylabel="standard uncertainty")
    right.legend(loc="best", markerscale=2)
    return figure


def psf_map(result: TransferResult) -> Figure:
    """Draw the PSF relative to its peak, and its cuts through the centroid with ±3σ."""
    figure = new_figure(9.0, 4.1)
    left, right = figure.subplots(1, 2)
    psf, std = result.psf
    at = result.measurement.position_um
    peak = float(psf.max())
    extent = (at[0], at[-1], at[0], at[-1])
    image = left.imshow(
        psf / peak, origin="lower", extent=extent, cmap="RdBu_r", vmin=-1, vmax=1,
        interpolation="nearest",
    )  # fmt: skip
    pitch = result.measurement.scan.pitch_um
    left.add_patch(Rectangle((-pitch / 2, -pitch / 2), pitch, pitch, fill=False, ls=":", ec=INK))
    left.set(title="PSF, relative to its peak", xlabel="x (µm)", ylabel="y (µm)")
    left.grid(visible=False)
    figure.colorbar(image, ax=left, shrink=0.85)
    middle = len(at) // 2
    for name, style, line, spread in (
        ("along x", "-", psf[middle], std[middle]),
        ("along y", "--", psf[:, middle], std[:, middle]),
    ):
        drawn = right.plot(at, line / peak, style, label=name)[0]
        right.fill_between(
            at, (line - 3 * spread) / peak, (line + 3 * spread) / peak,
            color=drawn.get_color(), alpha=0.25, lw=0,
        )  # fmt: skip
    right.set(title="through the centroid, ± 3σ", xlabel="µm")
    right.legend(loc="upper right")
    return figure


def _show(
    figure: Figure,
    axes: Axes,
    result: TransferResult,
    shown: np.ndarray,
    title: str,
    **how: object,
) -> None:
    """Show a map of frequencies with Nyquist's square."""
    axis = PER_MM * result.measurement.frequency_per_um
    image = axes.pcolormesh(axis, axis, shown, shading="nearest", rasterized=True, **how)  # type: ignore[arg-type]
    nyquist = PER_MM * 0.5 / result.measurement.scan.pitch_um
    axes.add_patch(
        Rectangle((-nyquist, -nyquist), 2 * nyquist, 2 * nyquist, fill=False, ls=":", ec=INK)
    )
    axes.set(title=title, aspect="equal", **_FREQUENCY)
    axes.grid(visible=False)
    figure.colorbar(image, ax=axes, shrink=0.85)
