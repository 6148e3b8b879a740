"""An EMVA 1288 data sheet of a simulated line camera: its figures, drawn into a folder.

    python examples/emva1288.py [--out docs/gallery] [--page sheet.html]

The camera is bare, as the standard wants it: its preset without the lens's vignette, with a dark
current. What was put in is printed beside what the data sheet says, as a Markdown table.
"""

import argparse
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from numpy.random import default_rng

from calib.forward.effects.dark_current import DarkCurrent
from calib.forward.effects.illumination import Illumination
from calib.forward.model import Model
from calib.forward.simulate import simulate
from calib.recording.header import Block, RecordingHeader
from calib.recording.open import open_recording
from calib.recording.writer import RecordingWriter
from calib.report.style import house_style
from calib.transfer.emva1288.data_sheet import data_sheet
from calib.transfer.emva1288.report.page import figures, write_page
from calib.transfer.emva1288.report.words import rounded
from calib.transfer.emva1288.sheet import DataSheet

LINES, STACK = 32, 256
EXPOSURES_US = (5.0, *np.arange(15.0, 300.0, 15.0).tolist())
HALF_US = 135.0
RADIANCE = 10.0
EFFICIENCY, DARK_E_PER_US = 0.6, 0.5
SHOWN = ("photon-transfer", "signal-to-noise", "prnu-spectrograms", "defects")


def main() -> None:
    """Simulate, reduce, draw and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("docs/gallery"))
    parser.add_argument("--page", type=Path, default=None)
    asked = parser.parse_args()
    asked.out.mkdir(parents=True, exist_ok=True)
    model = bare_camera()
    sheet = measured(model)
    with house_style():
        for drawn in figures(sheet):
            if drawn.name in SHOWN:
                drawn.figure.savefig(asked.out / f"emva1288-{drawn.name}.png")
    if asked.page is not None:
        write_page(asked.page, sheet)
    print_table(model, sheet)


def bare_camera() -> Model:
    """Return the preset without a lens, with a dark current, lit by an LED of known photons."""
    model = Model.preset("modern-12bit").without("vignette")
    model = model.with_effect(Illumination(radiance=(RADIANCE,)))
    model = model.with_effect(DarkCurrent(electrons_per_us=DARK_E_PER_US))
    source = model.source.model_copy(
        update={
            "kind": "led",
            "wavelength_nm": 850.0,
            "photons_per_pixel_per_us": electrons_per_us(model) / EFFICIENCY,
            "certificate_relative_std": 0.01,
        }
    )
    camera = model.camera.model_copy(update={"line_period_us": 400.0})
    return replace(model, source=source, camera=camera)


def electrons_per_us(model: Model) -> float:
    """Return what a column of mean responsivity gathers at level 1."""
    truth = model.truth()
    return RADIANCE * float(np.mean(truth.responsivity)) / truth.system_gain_dn_per_e


def measured(model: Model) -> DataSheet:
    """Record flats and darks to beyond saturation, many of them at half of it, and reduce them."""
    conditions = [(kind, t, lit) for t in EXPOSURES_US for kind, lit in (("dark", 0), ("flat", 1))]
    blocks = [
        Block(
            block=f"{number:03d}",
            kind=kind,
            exposure_us=exposure_us,
            level=level,
            lines=STACK if exposure_us == HALF_US else LINES,
        )
        for number, (kind, exposure_us, level) in enumerate(conditions)
    ]
    with TemporaryDirectory() as folder:
        path = Path(folder) / "modern-12bit.h5"
        header = RecordingHeader(camera=model.camera, source=model.source)
        with RecordingWriter.create(path, header, LINES) as writer:
            drawn = simulate(model, blocks, default_rng(1288), frame_lines=LINES)
            for block, frames in drawn:
                writer.begin_block(block)
                for dn in frames:
                    writer.append(dn)
                writer.end_block(block)
        return data_sheet(open_recording(path))


def print_table(model: Model, sheet: DataSheet) -> None:
    """Print what was put in beside what was found."""
    truth = model.truth()
    known = (
        ("system_gain_dn_per_e", truth.system_gain_dn_per_e),
        ("read_noise_e", truth.read_noise_e),
        ("quantum_efficiency", EFFICIENCY),
        ("dark_current_mean_e_per_s", DARK_E_PER_US * 1e6),
        ("dark_current_variance_e_per_s", DARK_E_PER_US * 1e6),
    )
    print("| figure | put in | found |\n|---|---|---|")
    for name, value in known:
        print(f"| {name} | {value:.6g} | {rounded(sheet[name])} {sheet[name].unit} |")
    for warning in sheet.warnings:
        print(f"\n{warning}")


if __name__ == "__main__":
    main()
