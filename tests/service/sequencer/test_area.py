"""An area camera through the sequencer, and `simulate`: frames as they are, counted as lines."""

import os
from dataclasses import replace

import numpy as np
import pytest

from calib.errors import InputError
from calib.forward.effects.spot import Spot
from calib.forward.model import Model
from calib.recording.file_recording import FileRecording
from calib.recording.folder import export_folder
from calib.recording.open import open_recording
from calib.recording.statistics import column_statistics
from service.bench import open_bench
from service.cli.simulated_recording import simulate_recording
from service.plan.describe import describe
from service.sequencer.begin import camera_settings
from service.sequencer.errors import RunRefusedError
from service.sequencer.look_ahead import BRIGHTEST_KEY
from service.sequencer.run import run_plan
from tests.service.sequencer.benches import assert_dark, in_process, short_plan

ROWS, COLUMNS = 48, 64
DEMO = Model.preset("demo")
SINGLE_TAP = ("system_gain", "offset", "vignette")
CAMERA = DEMO.camera.model_copy(
    update={"rows": ROWS, "columns": COLUMNS, "taps": 1, "tap_layout": "single"}
)


def area_model():
    plain = (
        replace(e, tap_gain=(), tap_layout="single") if e.name == "system_gain"
        else replace(e, tap_offset_dn=(), tap_layout="single") if e.name == "offset"
        else e
        for e in DEMO.effects if e.name != "vignette"
    )  # fmt: skip
    return replace(DEMO, camera=CAMERA, effects=(*plain, Spot(diameter_columns=16.0)))


MODEL = area_model()


def expected_dn(exposure_us):
    """Return the mean code of each pixel under one lamp, (n_rows, n_columns)."""
    truth = MODEL.truth()
    spot = MODEL.effect("spot").profile((ROWS, COLUMNS))
    return 10.2 * exposure_us * spot * truth.responsivity + truth.dark_offset_dn


@pytest.fixture
def bench(tmp_path):
    MODEL.save(tmp_path / "area.toml")
    settings = in_process(f"area-{os.getpid()}", model=str(tmp_path / "area.toml"))
    with open_bench(settings) as opened:
        yield opened


def area_plan(**changes):
    camera = {"line_period_us": 1000.0, **changes.pop("camera", {})}
    return short_plan(**{"camera": camera, "lines": 5, "frame_lines": None, **changes})


def test_frames_are_recorded_as_they_are_and_counted_as_lines(bench, out):
    result = run_plan(bench, area_plan(), out)
    assert (result.state, result.frames) == ("succeeded", 4 * 5)
    recording = FileRecording(out)
    assert recording.warnings == ()
    assert (recording.header.camera.rows, recording.header.camera.columns) == (ROWS, COLUMNS)
    for block in recording.header.blocks:
        frames = np.concatenate(list(recording.frames(block.block)))
        assert block.lines == 5
        assert frames.shape == (5, ROWS, COLUMNS)
    assert_dark(bench.world)


def test_pixels_have_the_means_of_the_model(bench, out):
    run_plan(bench, area_plan(lines=200, darks="none"), out)
    for fit in column_statistics(FileRecording(out)).fit:
        z = fit.mean_dn - expected_dn(fit.block.exposure_us).ravel()
        z /= np.sqrt(fit.variance_dn2 / fit.n_lines)
        assert abs(z.mean()) < 5 / np.sqrt(z.size)
        assert abs(z.std() - np.sqrt(199 / 197)) < 5 / np.sqrt(2 * z.size)


def test_a_plans_region_is_read_out(bench, out):
    camera = {"rows": 16, "first_row": 16, "columns": 24, "first_column": 24}
    run_plan(bench, area_plan(camera=camera, lines=50), out)
    frames = np.concatenate(list(FileRecording(out).frames("003"))).astype(np.float64)
    assert frames.shape == (50, 16, 24)
    assert FileRecording(out).header.camera.region == "24:48,16:32"
    expected = expected_dn(100.0)[16:32, 24:48]
    z = (frames.mean(0) - expected) / (frames.std(0, ddof=1) / np.sqrt(50))
    assert abs(z.mean()) < 5 / np.sqrt(z.size)
    assert abs(z.std() - np.sqrt(49 / 47)) < 5 / np.sqrt(2 * z.size)


def test_what_is_seen_live_are_columns_from_all_over_the_frame(bench, out):
    seen = {}
    run_plan(bench, area_plan(), out, on_columns=lambda live: seen.update({live.block: live}))
    assert all(live.mean_dn.shape == (COLUMNS,) for live in seen.values())
    flat, dark = seen["003"].mean_dn, seen["002"].mean_dn
    assert flat[COLUMNS // 2] > dark[COLUMNS // 2] + 50.0
    assert flat[0] < dark[0] + 20.0


def test_the_brightest_pixel_is_what_saturation_is_predicted_from(bench, out):
    """The spot fills a twentieth of the frame: no column's mean comes near to saturating."""
    plan = area_plan(
        sweep={"type": "exposure", "exposures_us": [50.0, 100.0, 990.0], "level": 2},
        darks="before",
        saturation={"action": "skip"},
    )
    result = run_plan(bench, plan, out)
    assert result.skipped == ("005",)
    taken = FileRecording(out).header.blocks[-1]
    expected = 20.1 * 100.0 * 5.0 * 0.15 + 64.0
    assert taken.model_extra[BRIGHTEST_KEY] == pytest.approx(expected, rel=0.06)


def test_a_run_goes_on_after_it_was_cancelled(bench, out):
    seen = []
    plan = area_plan()
    run_plan(bench, plan, out, cancelled=lambda: len(seen) > 7, on_columns=seen.append)
    assert run_plan(bench, plan, out, resume=True).state == "succeeded"
    assert [block.lines for block in FileRecording(out).header.blocks] == [5] * 4


def test_a_run_does_not_go_on_with_other_rows(bench, out):
    run_plan(bench, area_plan(), out)
    bench.sensor_rows = ROWS - 8
    with pytest.raises(RunRefusedError, match=r"64 columns and 48 rows.* 64 columns and 40 rows"):
        run_plan(bench, area_plan(), out, resume=True)


SIZES = {
    "an area camera tells its rows": ({"DeviceScanType": "Areascan"}, 48 - 8),
    "a linescan camera has none": ({"DeviceScanType": "Linescan"}, None),
}


@pytest.mark.parametrize(("told", "rows"), SIZES.values(), ids=SIZES)
def test_rows_are_those_that_the_camera_tells(bench, monkeypatch, told, rows):
    features = {"WidthMax": "64", "HeightMax": "48", **told}
    monkeypatch.setattr(bench.camera, "features", lambda: features)
    bench.sensor_columns = bench.sensor_rows = None
    plan = area_plan(camera={"first_row": 8} if rows else {})
    wanted = camera_settings(plan, bench, 50.0)
    assert (wanted.n_columns, wanted.n_rows) == (64, rows)
    assert wanted.frame_lines == (1 if rows else 5)


def test_simulate_draws_the_frames_that_a_bench_records(tmp_path):
    camera = {"rows": 32, "first_row": 8, "columns": 48}
    plan = area_plan(camera=camera, source={"lamps": 6})
    drawn = simulate_recording(MODEL, plan, tmp_path / "a.h5", seed=1, scenes_folder=tmp_path)
    assert (drawn.header.camera.rows, drawn.header.camera.columns) == (32, 48)
    flat = np.concatenate(list(drawn.frames("003")))
    assert flat.shape == (5, 32, 48)
    assert flat.mean(0)[16, 32] > 400
    folder = export_folder(drawn, tmp_path / "folder")
    assert open_recording(tmp_path / "folder").digest() == drawn.digest() == folder.digest()


REFUSED = {
    "rows beyond the last": ({"rows": 40, "first_row": 10}, {}, "rows up to 50.* has 48"),
    "a first row beyond the last": ({"first_row": 50}, {}, "rows up to 50.* has 48"),
    "several frames as one": ({}, {"frame_lines": 5}, "frame_lines is 5"),
}


@pytest.mark.parametrize(("camera", "plan", "said"), REFUSED.values(), ids=REFUSED)
def test_simulate_refuses_what_the_sensor_does_not_have(tmp_path, camera, plan, said):
    with pytest.raises(InputError, match=said) as caught:
        simulate_recording(
            MODEL, area_plan(camera=camera, **plan), tmp_path / "a.h5",
            seed=1, scenes_folder=tmp_path,
        )  # fmt: skip
    assert caught.value.code == "plan-does-not-fit-model"
    assert list(tmp_path.iterdir()) == []


def test_rows_of_a_line_sensor_are_refused(tmp_path):
    with pytest.raises(InputError, match=r"rows up to 4.* has 0") as caught:
        simulate_recording(
            DEMO, area_plan(camera={"rows": 4}), tmp_path / "a.h5", seed=1, scenes_folder=tmp_path
        )
    assert caught.value.code == "plan-does-not-fit-model"


def test_a_plan_says_how_much_room_its_frames_need():
    plan = area_plan(camera={"rows": 2000, "columns": 2400}, lines=100)
    # 4 blocks of 100 frames of 2,000 x 2,400 pixels of 2 bytes, and little beside.
    size = float(describe(plan).split("; ")[-1].removesuffix(" MB"))
    assert size == pytest.approx(4 * 100 * 2000 * 2400 * 2 / 1e6, rel=1e-3)
