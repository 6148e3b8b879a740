"""The 2018 paper's Sections 4, 5 and 7 again, simulated: what its filter gives, and what ours.

    python examples/mtf.py [--out docs/gallery] [--long]

It prints, as Markdown tables, what docs/mtf.md compares with the paper; that needs --long.
"""

import argparse
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from numpy.random import Generator, default_rng
from numpy.typing import NDArray

from calib.mtf.answer import answer
from calib.mtf.assembly.oversampled import Oversampled, oversampled
from calib.mtf.estimate import TransferMap, band_limited_psf
from calib.mtf.filter.filter_estimate import filter_estimate
from calib.mtf.filter.regressive_filter import RegressiveFilter
from calib.mtf.filter.thumbnails import Thumbnails
from calib.mtf.filter.window import Window
from calib.mtf.geometry import Alignment, Scan
from calib.mtf.grating.grating import Grating
from calib.mtf.measure import Measurement, measure
from calib.mtf.report.page import figures
from calib.mtf.result import TransferResult
from calib.mtf.scan_images import ScanImages
from calib.mtf.simulation.bench import Bench
from calib.mtf.simulation.detector import DetectorNoise
from calib.mtf.simulation.response import centred
from calib.mtf.simulation.shapes import Shape, square, truncated_corner
from calib.report.style import BLUE, GREY, ORANGE, house_style, new_figure

SCAN = Scan(25.0, 1, 6)
ORDERS_24, ORDERS_48 = Grating(650, 500.0), Grating(5525, 2 * 5525**0.5 / 0.120)
CORNER, SQUARE = truncated_corner(25.0, 10.0, 0.2, 2.5), square(25.0, 0.5)
NOISE = DetectorNoise(shot_noise=True, gain_std=0.01, averaged=100)
TAPERS = (0.25, 0.5, 1.0)


def main() -> None:
    """Simulate, reduce, draw and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("docs/gallery"))
    parser.add_argument("--long", action="store_true", help="128 × 128 pixels, 48 orders, 100 runs")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    with house_style():
        for name, figure in drawn(default_rng(2018), long=options.long):
            figure.savefig(options.out / f"mtf-{name}.png")


def drawn(rng: Generator, *, long: bool) -> Iterator[tuple[str, Figure]]:
    """Yield the gallery's figures by name."""
    shape = (128, 128) if long else (48, 48)
    section_4(rng, shape, (ORDERS_48, ORDERS_24)[not long :], TAPERS if long else (0.5,))
    yield "noise-runs", section_5(rng, shape, 100 if long else 20)
    result = section_7(rng, shape)
    for name in ("transfer", "cuts", "psf", "noise", "bench"):
        yield name, figures(result)[name]


def section_4(
    rng: Generator,
    shape: tuple[int, int],
    gratings: tuple[Grating, ...],
    tapers: tuple[float, ...],
) -> None:
    """Print the errors of both methods on the paper's pixel."""
    print("\n| | largest error | rms | PSF, band-limited | PSF |\n|---|---|---|---|---|")
    quiet = DetectorNoise(shot_noise=True, averaged=100)
    for grating in gratings:
        found = reduced(rng, shape, grating, CORNER, detector=quiet)
        print(f"| {grating.n_orders} orders, regularised {told(found, found.psf, CORNER)}")
        for taper in tapers:
            filtered = filter_estimate(found.fit, found.shift_um, taper=taper)
            cells = told(found, filtered, CORNER)
            print(f"| {grating.n_orders} orders, filter, taper {taper:g} {cells}")


def section_5(rng: Generator, shape: tuple[int, int], runs: int) -> Figure:
    """Print and draw σ_TF over noisy runs beside Eq. 10 as derived and as printed."""
    found = reduced(rng, shape, ORDERS_24, CORNER)
    grid = oversampled(found.fit, found.shift_um, select_harmonics=True)
    window = Window(3 * SCAN.pitch_um / SCAN.step_um)
    every = Thumbnails(window, grid.covered).count
    counts = [every // 16, every // 8, every // 4, every // 2, every]
    rows = [noisy_runs(rng, grid, window, n, runs) for n in counts]
    print("\n| thumbnails | measured | derived | printed |\n|---|---|---|---|")
    for count, row in zip(counts, rows, strict=True):
        print(f"| {count} | {row[0]:.4f} | {row[1]:.4f} | {row[2]:.5f} |")
    figure = new_figure(5.0, 3.4)
    axes = figure.subplots()
    measured, derived, printed = np.array(rows).T
    axes.loglog(counts, derived, color=BLUE, label="Eq. 10 as derived")
    axes.loglog(counts, measured, "o", color=ORANGE, label=f"{runs} noisy images")
    axes.loglog(counts, printed, "--", color=GREY, label="Eq. 10 as printed")
    axes.set(
        title="σ of the transfer function, disc's mean", xlabel="thumbnails", ylabel="σ_TF/σ_I"
    )
    axes.legend(loc="best")
    return figure


def section_7(rng: Generator, shape: tuple[int, int]) -> TransferResult:
    """Print what the simulated experiment finds; return it."""
    stage = rng.normal(scale=0.1, size=(SCAN.positions, 2))
    stage[17, 0] += 1.5
    bench = Alignment(np.array([31.0, -12.0]), 0.0, np.radians(0.1), stage)
    result = TransferResult(reduced(rng, shape, ORDERS_24, SQUARE, alignment=bench))
    print()
    for axis, zero in zip("xy", result.first_zeros, strict=True):
        print(f"first zero along {axis}: {zero.value:.4f} ± {zero.std:.4f} /mm (true: 40)")
    at = np.array([0.060])
    beyond, true = result.measurement.transfer.at(at, np.zeros(1)), SQUARE.transfer(at, np.zeros(1))
    print(f"at 60/mm: {beyond.transfer.real[0, 0]:+.5f} ± {beyond.real_std[0, 0]:.5f}", end=" ")
    print(f"(true: {true.real[0]:+.5f})")
    values, error = compared(result.measurement, result.measurement.psf, SQUARE)
    z = (error.real / np.maximum(values.real_std, 1e-9))[values.valid]
    print(f"within 3σ: {100 * (np.abs(z) < 3).mean():.1f} % of the disc")
    for warning in answer(result)["warnings"]:
        print(f"! {warning}")
    return result


def reduced(
    rng: Generator,
    shape: tuple[int, int],
    grating: Grating,
    response: Shape,
    *,
    detector: DetectorNoise = NOISE,
    alignment: Alignment | None = None,
) -> Measurement:
    """Simulate a scan and reduce it."""
    bench = Bench(SCAN, grating, response, shape, alignment or Alignment(), detector)
    return measure(ScanImages.whole(SCAN, grating, bench.record(rng)))


def compared(
    found: Measurement, estimate: object, response: Shape
) -> tuple[TransferMap, NDArray[np.complexfloating]]:
    """Return an estimate on the file's axis, and its error."""
    axis = found.frequency_per_um
    values: TransferMap = estimate.at(axis, axis)  # type: ignore[attr-defined]
    fy, fx = np.meshgrid(axis, axis, indexing="ij")
    return values, values.transfer - centred(response, fx, fy)


def told(found: Measurement, estimate: object, response: Shape) -> str:
    """Return a table's cells: errors of the transfer function and of the PSF, and where."""
    values, error = compared(found, estimate, response)
    size = np.abs(error)[values.valid]
    at = found.position_um
    truth = response.density(*np.meshgrid(at, at))
    known = np.where(values.valid, values.transfer, 0)
    cells = []
    for psf in (band_limited_psf(known, found.frequency_per_um, at), estimate.psf(at)[0]):  # type: ignore[attr-defined]
        away = (psf - truth) / truth.max()
        y, x = np.unravel_index(np.abs(away).argmax(), away.shape)
        cells.append(f"{100 * np.abs(away).max():.1f} % at ({at[x]:.0f}, {at[y]:.0f}) µm")
    transfer = f"{100 * size.max():.3f} % | {100 * np.sqrt((size**2).mean()):.3f} %"
    return f"| {transfer} | {cells[0]} | {cells[1]} |"


def noisy_runs(
    rng: Generator, grid: Oversampled, window: Window, count: int, runs: int
) -> tuple[float, float, float]:
    """Return σ_TF/σ_I over noisy images, as derived and as printed: means over the disc."""
    filtering = RegressiveFilter.of(Thumbnails(window, grid.covered, count), grid.pattern)
    axis = np.linspace(-1, 1, 17) * ORDERS_24.max_frequency_per_um * grid.step_um
    frequency = np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2)
    frequency = frequency[np.hypot(*frequency.T) <= axis[-1]]
    images = (rng.normal(size=grid.image.shape) * grid.covered for _ in range(runs))
    seen = [filtering.transfer(filtering.numerator(image), frequency) for image in images]
    return (
        float(np.std(seen, axis=0).mean()),
        float(filtering.noise_gain(frequency).mean()),
        float(filtering.printed_gain(frequency).mean()),
    )


if __name__ == "__main__":
    main()
