"""`darkflat investigate` where the camera sends packets: GigE Vision over loopback."""

import importlib.util
import os
from collections.abc import Callable
from pathlib import Path

import pytest

from calib.forward.effects.exposure_offset import ExposureOffset
from calib.recording.open import open_recording
from tests.calib.diagnosis.investigations import CASES, COLUMNS, first_plan
from tests.calib.diagnosis.recordings import plain_model
from tests.contracts.simulated_camera import ADDRESS_WAIT_S
from tests.service.cli.answers import Ran
from tests.service.cli.conftest import home, run

__all__ = ["home", "run"]

pytestmark = [
    pytest.mark.aravis,
    pytest.mark.skipif(importlib.util.find_spec("gi") is None, reason="PyGObject is not there"),
]

OFFSET_US = -0.8


def bench_file(folder: Path) -> Path:
    plain_model(COLUMNS).with_effect(ExposureOffset(OFFSET_US)).save(folder / "model.toml")
    (folder / "bench.toml").write_text(f"""
id = "investigate-packets-{os.getpid()}"
[camera]
driver = "aravis"
[light]
driver = "mock"
tau_s = 0.004
ramp_s = 0.01
[monitor]
driver = "mock"
integration_s = 0.005
[shutter]
driver = "mock"
[simulation]
model = "./model.toml"
lamps = 4
camera_wait_s = {ADDRESS_WAIT_S}
""")
    return folder / "bench.toml"


def test_one_more_sweep_of_packets_settles_stray_light_or_exposure_offset(
    run: Callable[..., Ran], tmp_path: Path
) -> None:
    plan = tmp_path / "first.toml"
    plan.write_text(first_plan(CASES["stray light or exposure offset"]).dumps())
    out = tmp_path / "out"
    ran = run("investigate", "--bench", bench_file(tmp_path), "--plan", plan, "--out", out,
              "--budget-s", 600, "--json", "-")  # fmt: skip
    assert ran.status == 0, ran.stderr
    first, *more = ran.json["rounds"]
    # The first sweep has no dark: both names are left, and nothing but darks tells them apart.
    assert {"stray_light", "exposure_offset"} <= set(first["names"][0])
    assert ran.json["outcome"] == "decided"
    assert 1 <= len(more) <= 2
    kinds = {block.kind for block in open_recording(out / "2.h5").header.blocks}
    assert "dark" in kinds
    (finding,) = ran.json["diagnosis"]["findings"]
    assert finding["effect"] == "exposure_offset"
    found = finding["parameters"]["offset_us"]
    assert abs(found["value"] - OFFSET_US) < 5.0 * found["std"]
