"""The sound files that every case starts from.

plan.toml, model.toml, bench.toml, radiances.csv
rec/                        a recording folder that imports and calibrates
rec.h5, rec.frames.jsonl    the same, as a recording file
set.h5                      its coefficient set
scan/                       a scan of a self-imaging grating, whose transfer function is determined
slanted/                    the image of a slanted edge
"""

import os
from pathlib import Path

import numpy as np
from numpy.random import default_rng

from calib.forward.model import Model
from calib.mtf.geometry import Scan
from calib.mtf.grating.grating import Grating
from calib.mtf.simulation.bench import Bench
from calib.mtf.simulation.detector import DetectorNoise
from calib.mtf.simulation.edge import edge_image, noisy
from calib.mtf.simulation.folder import write_folder
from calib.mtf.simulation.shapes import square
from calib.radiometric.calibrate import calibrate
from calib.recording.folder import export_folder
from calib.recording.open import open_recording
from service.cli.simulated_recording import simulate_recording
from service.plan.model import Plan

COLUMNS = 64
LINES = 64

PLAN = f"""
name = "small"
lines = {LINES}
frame_lines = 32

[sweep]
type = "factorial"
exposures_us = [10.0, 40.0, 90.0]
levels = [2.0, 4.0]

[camera]
line_period_us = 100.0
pixel_format = "Mono12"
columns = {COLUMNS}
first_column = 480
serial = "D0001"
band = "NIR"

[source]
radiance = {{ 2 = 20.1, 4 = 40.2 }}

[settle]
tolerance_percent = 5.0
stable_for_s = 0.02
interval_s = 0.005
"""

BENCH = f"""
id = "bad-input-{os.getpid()}"

[camera]
driver = "mock"
paced = false

[light]
driver = "mock"
ramp_s = 0.0

[monitor]
driver = "mock"
integration_s = 0.001

[shutter]
driver = "mock"

[simulation]
model = "demo"
seed = 3
"""


def make_sound_files(folder: Path) -> None:
    """Write them into `folder`."""
    (folder / "plan.toml").write_text(PLAN)
    (folder / "bench.toml").write_text(BENCH)
    (folder / "radiances.csv").write_text("level,radiance\n2,20.1\n4,40.2\n")
    model = Model.preset("demo")
    model.save(folder / "model.toml")
    recording = simulate_recording(
        model, Plan.loads(PLAN), folder / "rec.h5", seed=17, scenes_folder=folder
    )
    export_folder(recording, folder / "rec")
    calibrate(open_recording(folder / "rec.h5")).coefficients.save(folder / "set.h5")
    _make_scan(folder / "scan")
    _make_edge(folder / "slanted")


def _make_scan(folder: Path) -> None:
    pixel, noise = square(25.0, 1.0), DetectorNoise(shot_noise=True)
    bench = Bench(Scan(25.0, 1, 3), Grating(50, 340.0), pixel, (28, 30), detector=noise)
    write_folder(folder, bench.scan, bench.grating, bench.record(default_rng(5)))


def _make_edge(folder: Path) -> None:
    light = edge_image(square(25.0, 1.0), 25.0, (120, 50), 0.0933)
    (folder / "frames").mkdir(parents=True)
    (folder / "mtf.toml").write_text("pitch_um = 25.0\n\n[edge]\n")
    np.save(folder / "frames/000.npy", noisy(light, DetectorNoise(), default_rng(6)))
