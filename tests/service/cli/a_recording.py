"""A small recording that calibrates, simulated once per session."""

from pathlib import Path

import pytest

from calib.forward.model import Model
from service.cli.simulated_recording import simulate_recording
from service.plan.model import Plan

PLAN = """
name = "small"
lines = 64
frame_lines = 32

[sweep]
type = "factorial"
exposures_us = [10.0, 40.0, 90.0]
levels = [2.0, 4.0]

[camera]
line_period_us = 100.0
pixel_format = "Mono12"
columns = 256
first_column = 400
serial = "D0001"
band = "NIR"

[source]
radiance = { 2 = 20.1, 4 = 40.2 }
"""


@pytest.fixture(scope="session")
def plan_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The plan, as a file."""
    path = tmp_path_factory.mktemp("plan") / "plan.toml"
    path.write_text(PLAN)
    return path


@pytest.fixture(scope="session")
def recording_file(tmp_path_factory: pytest.TempPathFactory, plan_file: Path) -> Path:
    """The recording; not to be changed."""
    out = tmp_path_factory.mktemp("recording") / "small.h5"
    folder = plan_file.parent / "scenes"
    model, plan = Model.preset("demo"), Plan.load(plan_file)
    simulate_recording(model, plan, out, seed=17, scenes_folder=folder)
    return out
