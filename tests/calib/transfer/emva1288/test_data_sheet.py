"""What a recording gives, what it does not, and why."""

import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from calib.errors import DarkflatError
from calib.forward.model import Model
from calib.recording.header import Block
from calib.recording.open import open_recording
from calib.recording.protocol import Recording
from calib.recording.statistics import CancelledError
from calib.transfer.emva1288.catalogue import CATALOGUE
from calib.transfer.emva1288.data_sheet import data_sheet
from calib.transfer.emva1288.sheet import DataSheet
from tests.calib.radiometric.in_memory import InMemory, record
from tests.calib.transfer.emva1288.drawn_camera import DrawnCamera, sweep
from tests.calib.transfer.emva1288.plans import Bench, bench

SIGMAS = 5.0


@pytest.fixture(scope="module")
def drawn() -> Bench:
    return bench(np.random.default_rng(101))


@pytest.fixture(scope="module")
def recording(drawn: Bench) -> InMemory:
    return drawn.record(np.random.default_rng(102), certificate_relative_std=0.02)


@pytest.fixture(scope="module")
def sheet(recording: InMemory) -> DataSheet:
    return data_sheet(recording)


def without(recording: InMemory, *kinds: str) -> InMemory:
    return of_blocks(recording, [b for b in recording.header.blocks if b.kind not in kinds])


def of_blocks(recording: InMemory, blocks: Sequence[Block]) -> InMemory:
    return replace(recording, header=recording.header.model_copy(update={"blocks": tuple(blocks)}))


def with_source(recording: InMemory, **source: object) -> InMemory:
    header = recording.header
    changed = header.source.model_copy(update=source)
    return replace(recording, header=header.model_copy(update={"source": changed}))


def test_a_sound_recording_gives_every_figure(sheet: DataSheet) -> None:
    assert list(sheet.figures) == [figure.name for figure in CATALOGUE]
    unknown = [name for name, e in sheet.figures.items() if not e.is_known]
    assert unknown == ["dark_current_doubling_c"]
    assert all(e.std >= 0 for e in sheet.figures.values() if e.is_known)


def test_figures_are_near_the_truth(sheet: DataSheet, drawn: Bench) -> None:
    for name, value in drawn.truth().items():
        known = sheet[name]
        assert abs(known.value - value) < SIGMAS * known.std, name


def test_the_answer_is_json_in_the_catalogues_order(sheet: DataSheet) -> None:
    told = json.loads(json.dumps(sheet.answer(), allow_nan=False))
    assert told["system_gain_dn_per_e"]["unit"] == "DN/e-"
    assert told["dark_current_doubling_c"]["value"] is None
    assert "temperature" in told["dark_current_doubling_c"]["reason"]
    assert [k for k in told if k in sheet.figures] == list(sheet.figures)


def test_the_photon_scale_stands_apart(sheet: DataSheet, recording: InMemory) -> None:
    scale = sheet.answer()["photon_scale"]
    assert scale["relative_std"] == pytest.approx(0.02)
    assert "quantum_efficiency" in scale["not_included_in"]
    other = data_sheet(with_source(recording, certificate_relative_std=None))
    assert other.answer()["photon_scale"]["relative_std"] is None
    assert other["quantum_efficiency"] == sheet["quantum_efficiency"]


def test_without_photons_there_is_no_efficiency_but_electrons(
    sheet: DataSheet, recording: InMemory
) -> None:
    found = data_sheet(with_source(recording, photons_per_pixel_per_us=None))
    for name in ("quantum_efficiency", "responsivity_dn_per_photon", "saturation_capacity_photons"):
        assert not found[name].is_known
        assert "photons_per_pixel_per_us" in found[name].reason
    assert found["saturation_capacity_e"].value == pytest.approx(
        sheet["saturation_capacity_e"].value, rel=1e-12
    )


def test_without_a_wavelength_there_is_no_efficiency(recording: InMemory) -> None:
    found = data_sheet(with_source(recording, wavelength_nm=None))
    assert "wavelength_nm" in found["quantum_efficiency"].reason
    assert found["responsivity_dn_per_photon"].is_known


def test_one_dark_exposure_stands_for_all_with_a_warning(
    sheet: DataSheet, recording: InMemory, drawn: Bench
) -> None:
    keep = drawn.exposures_us[4]
    blocks = [b for b in recording.header.blocks if b.kind == "flat" or b.exposure_us == keep]
    found = data_sheet(of_blocks(recording, blocks))
    assert any("alone stand for every exposure" in w for w in found.warnings)
    assert not found["dark_current_mean_e_per_s"].is_known
    assert found["system_gain_dn_per_e"].value == pytest.approx(
        sheet["system_gain_dn_per_e"].value, abs=3 * sheet["system_gain_dn_per_e"].std
    )


def test_a_line_sensor_of_the_forward_model_gives_the_models_gain_and_noise() -> None:
    model = Model.preset("demo")
    exposures = (5.0, 15.0, 30.0, 45.0, 60.0, 75.0, 90.0)
    blocks = [
        Block(block=f"{kind}{t:g}", kind=kind, exposure_us=t, level=level, lines=100)
        for t in exposures
        for kind, level in (("dark", 0), ("flat", 2))
    ]
    found = data_sheet(record(model, blocks, np.random.default_rng(9), 100))
    truth = model.truth()
    for name, value in (
        ("system_gain_dn_per_e", truth.system_gain_dn_per_e),
        ("read_noise_e", truth.read_noise_e),
    ):
        assert abs(found[name].value - value) < SIGMAS * found[name].std, name
    assert found["dsnu_row_e"].reason == found["prnu_pixel_percent"].reason
    assert "one row" in found["dsnu_row_e"].reason


def test_darks_at_two_temperatures_tell_the_doubling(drawn: Bench) -> None:
    rng = np.random.default_rng(103)
    cold = [_at(b, 30.0) for b in drawn.blocks()]
    exposures = [2000.0 * k for k in range(1, 7)]
    mild = [_at(b, 30.0, "m") for b in sweep(exposures) if b.kind == "dark"]
    warm = [_at(b, 44.0, "w") for b in sweep(exposures) if b.kind == "dark"]
    camera = drawn.camera
    hot = replace(camera, dark_current_e_per_s=4 * camera.dark_current_e_per_s)
    first, second = camera.record([*cold, *mild], rng), hot.record(warm, rng)
    both = InMemory(
        first.header.model_copy(update={"blocks": (*cold, *mild, *warm)}),
        {**first.stretches, **second.stretches},
    )
    found = data_sheet(both)
    every = found["dark_current_doubling_c"]
    assert abs(every.value - 7.0) < SIGMAS * every.std
    assert every.std < 0.1
    assert sorted(found.darks.currents_e_per_s) == [30.0, 44.0]
    known = found["dark_current_mean_e_per_s"]  # at the flats' temperature
    assert abs(known.value - camera.dark_current_e_per_s) < SIGMAS * known.std


def _at(block: Block, celsius: float, prefix: str = "") -> Block:
    return block.model_copy(update={"sensor_temperature_c": celsius, "block": prefix + block.block})


def test_quantisation_hides_a_small_dark_noise() -> None:
    camera = DrawnCamera(gain=0.05, read_noise_e=3.0, photons_per_us=1000.0)
    drawn = bench(np.random.default_rng(104), camera)
    found = data_sheet(drawn.record(np.random.default_rng(105)))
    gain = found["system_gain_dn_per_e"]
    assert abs(gain.value - 0.05) < SIGMAS * gain.std
    assert not found["read_noise_e"].is_known
    assert f"below {0.40 / gain.value:.3g} e" in found["read_noise_e"].reason
    assert not found["dynamic_range"].is_known
    assert found["temporal_dark_noise_dn"].value < np.sqrt(0.24)


def test_a_camera_that_saturates_below_full_scale_is_read_at_the_largest_variance() -> None:
    rng = np.random.default_rng(106)
    drawn = bench(rng, shares=np.linspace(0.04, 0.96, 24))
    made = drawn.record(rng)
    clipped = {b: tuple(np.minimum(f, 3000) for f in s) for b, s in made.stretches.items()}
    found = data_sheet(replace(made, stretches=clipped))
    assert any("largest temporal variance" in w for w in found.warnings)
    step = np.diff(found.transfer.signal_dn).max()
    assert 3000 - 2 * step < found["saturation_dn"].value < 3000
    gain = found["system_gain_dn_per_e"]
    assert abs(gain.value - drawn.camera.gain) < SIGMAS * gain.std


def test_saturation_that_is_not_reached_is_said_so(recording: InMemory, drawn: Bench) -> None:
    low = [b for b in recording.header.blocks if b.exposure_us <= 0.7 * drawn.saturation_us]
    found = data_sheet(of_blocks(recording, low))
    for name in ("saturation_dn", "snr_max_db", "dynamic_range", "linearity_error_percent"):
        assert "saturation was not reached" in found[name].reason
    assert found["system_gain_dn_per_e"].is_known
    assert any("saturation was not reached" in w for w in found.warnings)


def test_a_share_of_clipped_samples_in_the_standards_window_is_the_saturation_point() -> None:
    drawn = bench(np.random.default_rng(107), shares=(0.05, 0.2, 0.5, 0.7, 0.9, 1.0, 1.1))
    found = data_sheet(drawn.record(np.random.default_rng(108), frames=16))
    point, share = found["saturation_dn"], found.transfer.share_at_full_scale[5]
    assert 0.0005 < share < 0.004
    truth = drawn.truth()["saturation_dn"]
    assert abs(point.value - truth) < SIGMAS * point.std
    assert point.std < 3.0  # the samples counted, a tenth of their spread


def test_an_offset_that_wanders_widens_the_dark_current(
    sheet: DataSheet, recording: InMemory
) -> None:
    rng = np.random.default_rng(109)
    moved = {
        b.block: tuple(f + np.uint16(rng.integers(0, 6)) for f in recording.stretches[b.block])
        if b.kind == "dark"
        else recording.stretches[b.block]
        for b in recording.header.blocks
    }
    found = data_sheet(replace(recording, stretches=moved))
    assert any("leave a straight line" in w for w in found.warnings)
    name = "dark_current_mean_dn_per_s"
    assert found[name].std > 10 * sheet[name].std
    assert abs(found[name].value - sheet[name].value) < SIGMAS * found[name].std


def test_a_bent_photon_transfer_curve_widens_the_gain() -> None:
    drawn = bench(np.random.default_rng(110), DrawnCamera(rows=200, columns=200, bend=0.2))
    found = data_sheet(drawn.record(np.random.default_rng(111)))
    assert any("photon transfer curve is no straight line" in w for w in found.warnings)
    assert any("response curve is no straight line" in w for w in found.warnings)


def test_nonuniformity_that_noise_hides_is_not_resolved(drawn: Bench) -> None:
    smooth = replace(drawn, camera=replace(drawn.camera, dsnu=np.zeros((1, 1))))
    found = data_sheet(smooth.record(np.random.default_rng(112)))
    assert "not resolved" in found["dsnu_e"].reason
    variance = found["spatial_variance_dark_dn2"]
    assert abs(variance.value) < SIGMAS * variance.std


def test_few_frames_and_small_images_are_said() -> None:
    drawn = bench(np.random.default_rng(113), DrawnCamera(rows=20, columns=20))
    found = data_sheet(drawn.record(np.random.default_rng(114), stack=4))
    assert any("fewer than 16 frames" in w for w in found.warnings)
    assert any("too small for the highpass" in w for w in found.warnings)
    assert found["prnu_percent"].value == pytest.approx(found["prnu_unfiltered_percent"].value)


def test_black_that_is_cut_off_is_said(drawn: Bench) -> None:
    low = replace(drawn, camera=replace(drawn.camera, offset_dn=2.0))
    found = data_sheet(low.record(np.random.default_rng(115)))
    assert any("raise the black level" in w for w in found.warnings)


def test_progress_runs_to_the_end_and_cancelling_stops(recording: InMemory) -> None:
    told: list[float] = []
    data_sheet(recording, progress=told.append)
    assert told == sorted(told)
    assert told[-1] == pytest.approx(1.0)
    with pytest.raises(CancelledError):
        data_sheet(recording, cancelled=lambda: True)


def _refused(recording: Recording) -> str:
    with pytest.raises(DarkflatError) as caught:
        data_sheet(recording)
    assert "\n" not in str(caught.value)
    return caught.value.code


def test_bad_recordings_are_refused_with_a_stable_code(recording: InMemory, drawn: Bench) -> None:
    blocks = recording.header.blocks
    one = [b for b in blocks if b.kind == "dark" or b.exposure_us == drawn.exposures_us[2]]
    full = [b for b in blocks if b.kind == "dark" or b.exposure_us > drawn.saturation_us]
    bright = drawn.exposures_us[-1]
    two = [Block(block="x", kind="flat", exposure_us=1.1 * bright, level=1.0, lines=2), *full]
    brighter = replace(
        of_blocks(recording, two),
        stretches={**recording.stretches, "x": recording.stretches[full[-1].block]},
    )
    single = {b: (s[0][:1],) for b, s in recording.stretches.items()}
    lightless = [b.model_copy(update={"level": 0.0}) for b in blocks]
    assert _refused(without(recording, "dark")) == "no-darks"
    assert _refused(without(recording, "flat")) == "no-flats"
    assert _refused(of_blocks(recording, one)) == "one-exposure"
    assert _refused(brighter) == "all-saturated"
    assert _refused(replace(recording, stretches=single)) == "too-few-frames"
    assert _refused(of_blocks(recording, lightless)) == "flat-without-light"


def test_a_block_of_one_frame_is_left_out_with_a_warning(recording: InMemory, drawn: Bench) -> None:
    name = recording.header.blocks[3].block
    cut = {**recording.stretches, name: (recording.stretches[name][0][:1],)}
    found = data_sheet(replace(recording, stretches=cut))
    assert any(f"fewer than two frames: block(s) {name}" in w for w in found.warnings)
    assert len(found.transfer.light) == len(drawn.exposures_us) - 1


def test_a_radiance_that_every_flat_states_counts_in_place_of_the_level(
    sheet: DataSheet, recording: InMemory
) -> None:
    levels = {1: 1.0, 2: 1.7}
    changed = [
        b if b.kind == "dark" else b.model_copy(
            update={"level": 1.0 + (k % 4 == 1), "radiance": 5.0 * levels[1 + (k % 4 == 1)],
                    "exposure_us": b.exposure_us / levels[1 + (k % 4 == 1)]})
        for k, b in enumerate(recording.header.blocks)
    ]  # fmt: skip
    found = data_sheet(of_blocks(recording, changed))
    np.testing.assert_allclose(found.transfer.light, sheet.transfer.light, rtol=1e-12)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory, recording: InMemory) -> Path:
    """A folder with statistics.csv and no frames."""
    path = tmp_path_factory.mktemp("sums")
    camera = recording.header.camera
    (path / "recording.toml").write_text(
        f"[camera]\ncolumns = {camera.columns}\nrows = {camera.rows}\nbit_depth = 12\n"
        '[source]\nkind = "led"\nwavelength_nm = 530.0\nphotons_per_pixel_per_us = 250.0\n'
    )
    rows = ["block,kind,exposure_us,level,started_s,sensor_temperature_c,lines,radiance"]
    sums = ["block,samples,mean_dn,variance_dn2"]
    for b in recording.header.blocks:
        y = np.concatenate(recording.stretches[b.block]).astype(np.float64)
        rows.append(f"{b.block},{b.kind},{b.exposure_us},{b.level},,,,")
        variance = y.var(axis=0, ddof=1).mean()
        sums.append(f"{b.block},{y.size},{y.mean()},{variance}")
    (path / "conditions.csv").write_text("\n".join(rows) + "\n")
    (path / "statistics.csv").write_text("\n".join(sums) + "\n")
    return path


def test_what_sums_tell_is_told(folder: Path, sheet: DataSheet) -> None:
    found = data_sheet(open_recording(folder))
    for name in ("temporal_dark_noise_dn", "dark_current_mean_dn_per_s"):
        assert found[name].value == pytest.approx(sheet[name].value, rel=0.01)
        # Two frames are assumed of every block, also of the stack's sixteen.
        assert 0.9 < found[name].std / sheet[name].std < 2.0
    gain = found["system_gain_dn_per_e"]
    assert gain.value == pytest.approx(sheet["system_gain_dn_per_e"].value, abs=gain.std)


def test_the_rest_says_why_not(folder: Path) -> None:
    found = data_sheet(open_recording(folder))
    spatial = [c.name for c in CATALOGUE if c.section == "spatial"]
    assert all("only sums" in found[name].reason for name in spatial)
    assert found.spatial is None
