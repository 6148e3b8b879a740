"""AgCam's calibration again, from the presets: its Figures 3 to 7, drawn into a folder.

    python examples/agcam.py [--out docs/gallery] [--sensors 12]

It prints, as a Markdown table, what docs/agcam.md compares with the paper.
"""

import argparse
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from matplotlib.figure import Figure

from calib.forward.model import Model
from calib.radiometric.calibrate import calibrate
from calib.radiometric.calibration import Calibration
from calib.radiometric.correction.apply import Correction
from calib.radiometric.report import columns, correction, response
from calib.radiometric.uniformity import Uniformity, uniformity
from calib.recording.block_statistics import BlockStatistics
from calib.recording.protocol import Recording
from calib.recording.statistics import column_statistics
from calib.report import style
from service.cli.simulated_recording import simulate_recording
from service.plan.model import Plan

HERE = Path(__file__).parent
HELD_OUT_EVERY = 8
PATTERNS = 12  # sensors drawn anew, to see what the choice of the order depends on


@dataclass(frozen=True)
class Band:
    """A preset and the block whose uniformity the paper prints."""

    preset: str
    exposure_us: float


BANDS = (Band("agcam-nir", 200.0), Band("agcam-red", 300.0))


def main() -> None:
    """Simulate, calibrate, draw and print both bands."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("docs/gallery"))
    parser.add_argument("--sensors", type=int, default=PATTERNS, help="drawn anew, of either band")
    options = parser.parse_args()
    folder = options.out
    folder.mkdir(parents=True, exist_ok=True)
    plan = Plan.load(HERE / "plans" / "agcam.toml")
    with TemporaryDirectory() as scratch:
        for band in BANDS:
            path = Path(scratch) / f"{band.preset}.h5"
            model = Model.preset(band.preset)
            recording = simulate_recording(model, plan, path, seed=2010, scenes_folder=HERE)
            calibration = calibrate(recording)
            with style.house_style():
                for name, figure in figures(recording, calibration, band):
                    figure.savefig(folder / f"{band.preset}-{name}.png")
            print_table(recording, calibration, band)
    print_orders(plan, options.sensors)


def figures(
    recording: Recording, calibration: Calibration, band: Band
) -> Iterator[tuple[str, Figure]]:
    """Yield the figures of one band, named as the paper numbers them."""
    yield "fig3a-dark-offset", columns.dark_offset(calibration)
    yield "fig3b-slope", columns.slope(calibration)
    yield "fig4b-responsivity", columns.responsivity(calibration)
    yield "fig5-radiance-scale", response.radiance_scale(calibration)
    block = flat_at(recording, band.exposure_us)
    raw = next(iter(recording.frames(block)))
    made = Correction(calibration.coefficients, band.exposure_us, camera=recording.header.camera)
    yield "fig6-correction", correction.before_and_after(raw, made, block)


def print_table(recording: Recording, calibration: Calibration, band: Band) -> None:
    """Print what was found."""
    found, seen = calibration.coefficients, judged(recording, calibration, band)
    answer = calibration.answer()
    difference = answer["dark_offset_difference_dn"]
    offset = found.dark_offset_dn[found.valid]
    axis = f"{found.axis_column + 1:.0f}"
    rows = (
        ("DN0, lowest and highest", f"{offset.min():.1f} … {offset.max():.1f} DN"),
        ("DN0, mean by regression", f"{offset.mean():.3f} DN"),
        ("DN0, mean of capped darks", f"{answer['mean_dark_offset_dn']['capped']:.3f} DN"),
        ("capped less regression, unclipped columns",
         f"{difference['value']:+.4f} ± {difference['std']:.4f} DN"),
        ("fall at the edge", f"{found.edge_fall_percent:.1f} %"),
        ("axis, counted from 1", f"{axis} ± {found.axis_column_std or float('nan'):.0f}"),
        ("order by prediction", f"{calibration.figures.order_choice.chosen}"),
        ("order by residual variance", f"{calibration.figures.order_choice.by_residual}"),
        ("CoV before, mean line", f"{seen.before:.2f} %"),
        ("CoV after, mean line", f"{seen.after:.2f} %"),
        ("CoV before, single lines", f"{seen.before_single_line:.2f} %"),
        ("CoV after, single lines", f"{seen.after_single_line:.2f} %"),
    )  # fmt: skip
    print(f"\n{band.preset}, {band.exposure_us:g} µs\n")
    for name, value in rows:
        print(f"| {name} | {value} |")


def judged(recording: Recording, calibration: Calibration, band: Band) -> Uniformity:
    """Judge the set on the held-out lines of the block that the paper judges."""
    name = flat_at(recording, band.exposure_us)
    held = statistics_of(recording, name)
    every = HELD_OUT_EVERY
    lines = np.concatenate(list(recording.frames(name)))[every - 1 :: every]
    return uniformity(calibration.coefficients, held, [lines])


def statistics_of(recording: Recording, name: str) -> BlockStatistics:
    """Return the statistics of a block's held-out lines."""
    held = column_statistics(recording, held_out_every=HELD_OUT_EVERY).held_out
    return next(s for s in held if s.block.block == name)


def flat_at(recording: Recording, exposure_us: float) -> str:
    """Return the first flat of that exposure."""
    blocks = recording.header.blocks
    return next(b.block for b in blocks if b.kind == "flat" and b.exposure_us == exposure_us)


def print_orders(plan: Plan, sensors: int) -> None:
    """Print which orders are chosen when the sensor's pattern is drawn anew so many times."""
    short = plan.model_copy(update={"lines": 119, "frame_lines": 119})
    print(f"\norders chosen for {sensors} sensors: by prediction; by residual variance\n")
    for band in BANDS:
        chosen = [choice(band, short, seed) for seed in range(1, sensors + 1)]
        prediction, residual = (" ".join(map(str, sorted(c))) for c in zip(*chosen, strict=True))
        print(f"| {band.preset} | {prediction} | {residual} |")


def choice(band: Band, plan: Plan, seed: int) -> tuple[int, int]:
    """Return the orders that both rules choose for another sensor of the same make."""
    model = Model.preset(band.preset)
    pattern = model.effect("responsivity")
    model = model.with_effect(replace(pattern, prnu_seed=seed))  # type: ignore[type-var]
    with TemporaryDirectory() as scratch:
        path = Path(scratch) / "recording.h5"
        recording = simulate_recording(model, plan, path, seed=seed, scenes_folder=HERE)
        compared = calibrate(recording).figures.order_choice
    return compared.chosen, compared.by_residual


if __name__ == "__main__":
    main()
