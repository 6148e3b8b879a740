"""The sound files that every case starts from.

plan.toml, model.toml, bench.toml, radiances.csv
rec/                        a recording folder that imports and calibrates
rec.h5, rec.frames.jsonl    the same, as a recording file
set.h5                      its coefficient set
"""

import os
from pathlib import Path

from calib.forward.model import Model
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
