"""`simulate`: which model it takes, and what of it goes into the recording's header."""

from collections.abc import Callable
from pathlib import Path

import pytest

from calib.forward.model import Model
from calib.radiometric.coefficients.coefficient_set import CoefficientSet
from calib.radiometric.correction.apply_checks import _MUST_MATCH
from calib.recording.open import open_recording
from tests.service.cli.a_recording import PLAN
from tests.service.cli.answers import Ran
from tests.service.cli.benches import SETTLE, bench_file

Run = Callable[..., Ran]
OPEN = PLAN.replace('serial = "D0001"\n', "").replace('band = "NIR"\n', "")
"""A plan that leaves to bench and model who the camera is."""


def test_a_folder_called_like_the_preset_is_not_in_its_way(
    run: Run, plan_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "demo").mkdir()
    monkeypatch.chdir(tmp_path)
    ran = run("simulate", "demo", plan_file, "--out", tmp_path / "rec.h5")
    assert ran.status == 0, ran.stderr


@pytest.mark.parametrize(("stated", "lamps"), [("", 6), ("lamps = 5\n", 5)])
def test_the_lamps_are_the_models_unless_the_plan_states_them(
    run: Run, tmp_path: Path, stated: str, lamps: int
) -> None:
    assert Model.preset("demo").source.lamps == 6
    (tmp_path / "plan.toml").write_text(PLAN.replace("[source]\n", f"[source]\n{stated}"))
    ran = run("simulate", "demo", tmp_path / "plan.toml", "--out", tmp_path / "rec.h5")
    assert ran.status == 0, ran.stderr
    assert open_recording(tmp_path / "rec.h5").header.source.lamps == lamps


def test_a_set_from_a_sweep_fits_simulated_frames_of_the_same_model(
    run: Run, tmp_path: Path
) -> None:
    bench, plan = bench_file(tmp_path), tmp_path / "plan.toml"
    plan.write_text(OPEN + SETTLE)
    swept, drawn, found = (tmp_path / name for name in ("swept.h5", "drawn.h5", "set.h5"))
    for arguments in (
        ("sweep", plan, "--bench", bench, "--out", swept),
        ("simulate", "demo", plan, "--out", drawn),
        ("calibrate", swept, "--out", found),
        ("apply", found, drawn, "--out", tmp_path / "radiance.h5"),
    ):
        ran = run(*arguments)
        assert ran.status == 0, ran.stderr
    camera = CoefficientSet.load(found).camera
    assert (camera.serial, camera.band) == ("D0001", "NIR")
    other = open_recording(drawn).header.camera
    assert all(getattr(camera, name) == getattr(other, name) for name in _MUST_MATCH)


def test_a_set_of_one_half_of_a_sensor_is_refused_for_the_other_half(
    run: Run, tmp_path: Path
) -> None:
    for first in (0, 512):
        plan = tmp_path / f"{first}.toml"
        plan.write_text(
            OPEN.replace("columns = 256", "columns = 512").replace(
                "first_column = 400", f"first_column = {first}"
            )
            + SETTLE
        )
        ran = run("simulate", "demo", plan, "--out", tmp_path / f"{first}.h5")
        assert ran.status == 0, ran.stderr
    ran = run("calibrate", tmp_path / "0.h5", "--out", tmp_path / "set.h5")
    assert ran.status == 0, ran.stderr
    ran = run("apply", tmp_path / "set.h5", tmp_path / "512.h5", "--out", tmp_path / "out.h5")
    assert ran.status == 1
    assert "region is '0:512' in the set and '512:1024' in the lines" in ran.stderr
