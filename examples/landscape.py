"""A landscape swept across the line, raw and corrected, as in AgCam's Figs. 8 and 9.

    python examples/landscape.py [--preset agcam-red] [--exposure-us 200] [--out docs/gallery]

A simulated camera is calibrated as the paper's was, then sees a landscape whose radiance is known.
"""

import argparse
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.random import Generator, default_rng
from numpy.typing import NDArray

from calib.forward.conditions import Conditions
from calib.forward.model import Model
from calib.forward.simulate import simulate
from calib.radiometric.calibrate import calibrate
from calib.radiometric.coefficients.coefficient_set import CoefficientSet
from calib.radiometric.correction.apply import Correction
from calib.radiometric.estimation.source_uncertainty import SourceUncertainty
from calib.radiometric.landscape import Landscape
from calib.recording.header import Block, RecordingHeader
from calib.recording.open import open_recording
from calib.recording.writer import RecordingWriter
from calib.report.style import BLUE, GREY, INK, ORANGE, house_style, new_figure

UNIT = "radiance (W m⁻² sr⁻¹)"
LINES_PER_BLOCK, N_LINES, SKY_LINE = 300, 1500, 60
SCENES = {
    "agcam-nir": (300.0, Landscape(sky=12.0, field=14.0, woods=9.0)),
    "agcam-red": (200.0, Landscape(sky=5.2, field=2.6, woods=1.3)),
}
SOURCE = SourceUncertainty(certificate_relative_std=0.01)  # the simulated source is uniform


def calibrated(model: Model, rng: Generator) -> CoefficientSet:
    """Record the paper's sweeps with a simulated camera and calibrate it."""
    conditions = [("flat", t, 1) for t in (100.0, 200.0, 300.0, 400.0, 500.0)]
    conditions += [("dark", t, 0) for t in (100.0, 300.0, 500.0)]
    conditions += [("flat", 100.0, level) for level in range(2, 6)]
    blocks = [
        Block(block=f"{k:03d}", kind=kind, exposure_us=t, level=level, lines=LINES_PER_BLOCK)
        for k, (kind, t, level) in enumerate(conditions)
    ]
    with TemporaryDirectory() as folder:
        path = Path(folder) / "sweep.h5"
        header = RecordingHeader(camera=model.camera, source=model.source)
        with RecordingWriter.create(path, header, LINES_PER_BLOCK) as writer:
            for block, frames in simulate(model, blocks, rng, frame_lines=LINES_PER_BLOCK):
                writer.begin_block(block)
                for frame in frames:
                    writer.append(frame)
                writer.end_block(block)
        return calibrate(open_recording(path), source=SOURCE).coefficients


def cov_percent(line: NDArray[np.floating]) -> float:
    """Coefficient of variation along the line, percent."""
    return float(100 * np.nanstd(line) / np.nanmean(line))


def draw_image(
    axes: Axes, image: NDArray[np.generic], title: str, unit: str, figure: Figure
) -> None:
    """Show an image with time to the right and the line upwards."""
    shown = axes.imshow(
        image[:, ::6].T, origin="lower", cmap="gray", aspect="auto",
        extent=(0, len(image), 0, image.shape[1]), vmin=0, vmax=np.nanpercentile(image, 99.5),
        interpolation="antialiased",
    )  # fmt: skip
    axes.axvline(SKY_LINE, color=ORANGE, linewidth=1.2)
    axes.set(title=title, xlabel="line", ylabel="column")
    axes.grid(visible=False)
    figure.colorbar(shown, ax=axes, label=unit, pad=0.02)


def draw_raw_line(
    axes: Axes, line: NDArray[np.float64], correction: Correction, sky: float
) -> None:
    """Show the raw line of sky with what the vignette alone would make of it."""
    coefficients = correction.coefficients
    expected_dn = sky * np.nanmean(coefficients.responsivity) * correction.terms.exposure_us
    axes.plot(line, color=BLUE, linewidth=0.4)
    axes.plot(
        expected_dn * coefficients.vignette + np.nanmean(correction.terms.dark_dn),
        color=INK, linewidth=1.2, label="sky × vignette + mean offset",
    )  # fmt: skip
    cov = cov_percent(line / coefficients.vignette)
    axes.set(title=f"(c) a line of sky; CoV {cov:.2f} % once VE is divided out")
    axes.set(xlabel="column", ylabel="DN", ylim=(0, None))


def draw_corrected_line(
    axes: Axes,
    line: NDArray[np.float32],
    std: NDArray[np.float32],
    correction: Correction,
    sky: float,
) -> None:
    """Show the corrected line of sky on what its stated uncertainty allows."""
    axes.fill_between(
        np.arange(len(line)), sky - 2 * std, sky + 2 * std, color=GREY, alpha=0.6,
        linewidth=0, label="truth ± 2 stated std",
    )  # fmt: skip
    axes.plot(line, color=BLUE, linewidth=0.4)
    # the scale's error moves the whole line, and is no part of its scatter
    allowed = 100 * np.sqrt(np.nanmean((std / line) ** 2) - correction.terms.common)
    axes.set(title=f"(d) corrected; CoV {cov_percent(line):.2f} %, stated {allowed:.2f} %")
    axes.set(xlabel="column", ylabel=UNIT, ylim=(0, 1.35 * float(np.nanmax(line))))


def draw(dn: NDArray[np.generic], correction: Correction, sky: float) -> Figure:
    """Return the figure: images above, the marked line of sky below, raw left, corrected right."""
    corrected = correction.lines(dn)
    figure = new_figure(10.0, 6.4)
    grid = figure.subplots(2, 2)
    draw_image(grid[0, 0], dn, "(a) raw", "DN", figure)
    draw_image(grid[0, 1], corrected.radiance, "(b) corrected", UNIT, figure)
    draw_raw_line(grid[1, 0], dn[SKY_LINE].astype(np.float64), correction, sky)
    line, std = corrected.radiance[SKY_LINE], corrected.std[SKY_LINE]
    draw_corrected_line(grid[1, 1], line, std, correction, sky)
    for axes in grid[1]:
        axes.set_xlim(0, len(line))
        axes.legend(loc="lower center")
    camera = correction.camera.serial
    figure.suptitle(f"{camera}, {correction.terms.exposure_us:g} µs, simulated")
    return figure


def main() -> None:
    """Draw one preset, or all."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--preset", choices=sorted(SCENES))
    parser.add_argument("--exposure-us", type=float)
    parser.add_argument("--seed", type=int, default=2010)
    parser.add_argument("--out", type=Path, default=Path("docs/gallery"))
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    for preset in [options.preset] if options.preset else sorted(SCENES):
        exposure_us, landscape = SCENES[preset]
        exposure_us = options.exposure_us or exposure_us
        model, rng = Model.preset(preset), default_rng(options.seed)
        truth = landscape.image(N_LINES, model.camera.columns, rng)
        at = Conditions.steady(N_LINES, exposure_us=exposure_us, line_period_us=1400.0)
        dn = model.draw(at, rng, truth).dn
        correction = Correction(calibrated(model, rng), exposure_us, camera=model.camera)
        path = options.out / f"landscape-{preset}.png"
        with house_style():
            draw(dn, correction, landscape.sky).savefig(path)
        print(path)


if __name__ == "__main__":
    main()
