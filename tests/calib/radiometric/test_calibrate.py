import json
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest

from calib.errors import DarkflatError, InputError, NotDeterminedError
from calib.radiometric.calibrate import calibrate
from calib.radiometric.coefficients.coefficient_set import CoefficientSet
from calib.radiometric.coefficients.provenance import Provenance
from calib.radiometric.estimation.choices import Choices
from calib.radiometric.estimation.from_statistics import determine
from calib.radiometric.estimation.source_uncertainty import SourceUncertainty
from calib.recording.header import Block
from calib.recording.open import open_recording
from tests.calib.radiometric.in_memory import InMemory, agcam_plan, record
from tests.calib.radiometric.simulated import Bench, draw
from tests.calib.radiometric.small_camera import small_camera

MODEL = small_camera(256, axis_column=137.0)
LINES = 64


@pytest.fixture(scope="module")
def recording() -> InMemory:
    drawn = record(MODEL, agcam_plan(LINES), np.random.default_rng(), LINES)
    stated = {"certificate_relative_std": 0.008, "certificate": "C-17"}
    source = drawn.header.source.model_copy(update=stated)
    return InMemory(drawn.header.model_copy(update={"source": source}), drawn.stretches)


def test_the_coefficients_are_the_models(recording: InMemory) -> None:
    c, truth = calibrate(recording).coefficients, MODEL.truth()
    assert c.valid.all()
    for found, known, std in [
        (c.dark_offset_dn, truth.dark_offset_dn, c.dark_offset_dn_std),
        (c.vignette, truth.vignette, np.maximum(c.vignette_std, 1e-4)),
        (c.responsivity, truth.responsivity, c.responsivity_std),
    ]:
        assert (np.abs(found - known) < 6 * std).all()
    assert abs(c.axis_column - truth.axis_column) < 5 * (c.axis_column_std or 0)
    gain_std = c.system_gain_dn_per_e_std
    assert abs(c.system_gain_dn_per_e - truth.system_gain_dn_per_e) < 5 * gain_std
    assert abs(c.read_noise_e - truth.read_noise_e) < 5 * c.read_noise_e_std
    assert c.scale_relative_std == pytest.approx(0.008, rel=0.1)
    # QE at the axis has a share of common offsets that the scale has not, some 1e-6 of it here.
    assert c.budget.combined_common >= c.scale_relative_std * (1 - 1e-9)
    assert c.budget.combined_common == pytest.approx(c.scale_relative_std, rel=1e-3)


def test_the_set_says_where_it_comes_from_and_what_it_has_seen(
    recording: InMemory, tmp_path: Path
) -> None:
    calibration = calibrate(recording, plan="name = 'agcam'")
    calibration.coefficients.save(tmp_path / "set.h5")
    loaded = CoefficientSet.load(tmp_path / "set.h5")
    assert loaded.id == calibration.answer()["coefficient_set"]
    assert loaded.provenance.recording_digest == recording.digest()
    assert loaded.provenance.plan == "name = 'agcam'"
    assert loaded.provenance.certificate == "C-17"
    assert loaded.domain.exposure_us == (100.0, 500.0)
    assert loaded.domain.radiance == pytest.approx((0.0, 60.0), rel=1e-3)
    assert loaded.domain.temperature_c == (25.0, 25.0)


def test_the_same_recording_gives_the_same_id(recording: InMemory) -> None:
    assert calibrate(recording).coefficients.id == calibrate(recording).coefficients.id


def test_the_answer_is_json_with_the_contracts_names(recording: InMemory) -> None:
    answer = json.loads(json.dumps(calibrate(recording).answer(), allow_nan=False))
    assert answer["columns"] == answer["valid_columns"] == 256
    assert answer["cov_block"] in {b.block for b in recording.header.blocks}
    assert answer["cov_lines"] == LINES // 8
    assert answer["mean_dark_offset_dn"]["capped"] == pytest.approx(40.0, abs=2)
    assert answer["mean_dark_offset_dn"]["regression"] == pytest.approx(40.0, abs=2)
    assert answer["responsivity_at_axis"]["unit"] == "DN / (W m-2 sr-1 µs)"
    assert answer["responsivity_at_axis"]["value"] == pytest.approx(0.45, rel=0.1)
    assert answer["reduced_chi_squared"] == pytest.approx(1.0, abs=0.2)
    assert isinstance(answer["warnings"], list)
    assert {"vignette_order", "axis_column", "coefficient_set"} <= answer.keys()
    assert isinstance(answer["axis_column"], int)
    assert abs(answer["axis_column"] - answer["axis_column_exact"]) <= 0.5


def test_the_correction_leaves_the_noise_of_held_out_lines_only(recording: InMemory) -> None:
    calibration = calibrate(recording)
    answer, u = calibration.answer(), calibration.uniformity
    assert u is not None
    block = next(b for b in recording.header.blocks if b.block == u.block)
    truth = MODEL.truth()
    slope = truth.vignette * truth.responsivity
    signal = slope * block.exposure_us * (block.radiance or 0)
    noise = np.sqrt(0.05 * signal + (20 * 0.05) ** 2 + 1 / 12) / signal
    one_line = 100 * np.sqrt(np.mean(noise**2))
    assert answer["cov_after_single_line_percent"] == pytest.approx(one_line, rel=0.1)
    of_mean = one_line / np.sqrt(LINES / 8)
    assert of_mean * 0.8 < answer["cov_after_percent"] < of_mean * 1.5
    scatter = 100 * np.std(truth.responsivity) / np.mean(truth.responsivity)
    assert answer["cov_before_offset_removed_percent"] == pytest.approx(scatter, rel=0.1)
    assert answer["edge_fall_percent"] == pytest.approx(
        100 * (1 - truth.vignette[[0, -1]].min()), abs=3
    )


def test_a_type_b_uncertainty_widens_what_it_acts_on(recording: InMemory) -> None:
    plain = calibrate(recording).coefficients
    stated = SourceUncertainty(0.008, nonuniformity_relative=0.03, monitor_relative_std=0.005)
    wide = calibrate(recording, source=stated).coefficients
    assert wide.scale_relative_std == pytest.approx(
        np.sqrt(plain.scale_relative_std**2 + 0.03**2 / 3 + 0.005**2), rel=1e-6
    )
    assert wide.vignette_std[0] > plain.vignette_std[0]
    np.testing.assert_array_equal(wide.dark_offset_dn_std, plain.dark_offset_dn_std)


def test_a_table_of_radiances_sets_the_scale(recording: InMemory) -> None:
    plain = calibrate(recording).coefficients
    doubled = calibrate(recording, radiances={g: 20.0 * g for g in range(1, 7)}).coefficients
    np.testing.assert_allclose(doubled.slope, plain.slope / 2, rtol=1e-9)


def altered(recording: InMemory, blocks: Sequence[Block]) -> InMemory:
    header = recording.header.model_copy(update={"blocks": tuple(blocks)})
    return InMemory(header, recording.stretches)


def without_radiance(recording: InMemory) -> InMemory:
    blocks = recording.header.blocks
    return altered(recording, [b.model_copy(update={"radiance": None}) for b in blocks])


def test_without_radiance_only_a_relative_scale_is_given_and_said(recording: InMemory) -> None:
    bare = without_radiance(recording)
    with pytest.raises(NotDeterminedError) as refusal:
        calibrate(bare)
    assert refusal.value.code == "no-radiance"
    calibration = calibrate(bare, relative=True)
    assert calibration.coefficients.radiance_unit == "1"
    assert any("scale is relative" in text for text in calibration.warnings)


def saturated(recording: InMemory) -> InMemory:
    full = {
        b.block: tuple(
            np.full_like(f, 4095) if b.kind == "flat" else f for f in recording.stretches[b.block]
        )
        for b in recording.header.blocks
    }
    return InMemory(recording.header, full)


def of_kind(recording: InMemory, kind: str) -> InMemory:
    return altered(recording, [b for b in recording.header.blocks if b.kind == kind])


def of_one_exposure(recording: InMemory) -> InMemory:
    return altered(recording, [b for b in recording.header.blocks if b.exposure_us == 100.0])


def of_one_line(recording: InMemory) -> InMemory:
    one = {name: (frames[0][:1],) for name, frames in recording.stretches.items()}
    return InMemory(recording.header, one)


def of_an_area(recording: InMemory) -> InMemory:
    camera = recording.header.camera.model_copy(update={"rows": 4})
    return InMemory(recording.header.model_copy(update={"camera": camera}), recording.stretches)


@pytest.mark.parametrize(
    ("change", "code"),
    [
        (saturated, "all-saturated"),
        (lambda r: of_kind(r, "dark"), "no-flats"),
        (lambda r: of_kind(r, "flat"), "missing-darks"),
        (of_one_exposure, "one-exposure"),
        (of_one_line, "no-temporal-noise"),
        (of_an_area, "area-sensor"),
    ],
    ids=lambda v: v if isinstance(v, str) else "",
)
def test_what_cannot_be_calibrated_ends_in_one_sentence(
    recording: InMemory,
    change: Callable[[InMemory], InMemory],
    code: str,
) -> None:
    with pytest.raises(DarkflatError) as refusal:
        calibrate(change(recording), held_out_every=0)
    assert refusal.value.code == code
    assert "\n" not in str(refusal.value)
    assert str(refusal.value).endswith(".")


@pytest.mark.parametrize("value", [-0.1, 1.5, float("nan"), "0.01"])
def test_an_uncertainty_that_is_none_is_refused(value: float) -> None:
    with pytest.raises(InputError) as refusal:
        SourceUncertainty(certificate_relative_std=value)
    assert refusal.value.code == "bad-source-uncertainty"


def test_darks_can_be_done_without_where_asked(recording: InMemory) -> None:
    calibration = calibrate(of_kind(recording, "flat"), darks_required=False)
    assert calibration.darks is None
    assert calibration.answer()["mean_dark_offset_dn"]["capped"] is None
    assert any("not verified" in text for text in calibration.warnings)


def test_a_folder_is_calibrated_as_the_recording_is(recording: InMemory, tmp_path: Path) -> None:
    folder = tmp_path / "rec"
    (folder / "frames").mkdir(parents=True)
    camera = recording.header.camera
    (folder / "recording.toml").write_text(
        f'[camera]\nserial = "B0001"\ncolumns = {camera.columns}\nbit_depth = 12\n'
        'line_period_us = 1400.0\nband = "NIR"\n'
        '[source]\nkind = "sphere"\nlamps = 6\nradiance_unit = "W m-2 sr-1"\n'
        "certificate_relative_std = 0.008\n"
    )
    rows = ["block,kind,exposure_us,level,started_s,sensor_temperature_c,lines,radiance"]
    for b in recording.header.blocks:
        radiance = "" if b.kind == "dark" else b.radiance
        rows.append(
            f"{b.block},{b.kind},{b.exposure_us},{b.level:g},{b.started_s},"
            f"{b.sensor_temperature_c},{b.lines},{radiance}"
        )
        np.save(folder / "frames" / f"{b.block}.npy", np.vstack(recording.stretches[b.block]))
    (folder / "conditions.csv").write_text("\n".join(rows) + "\n")
    found = calibrate(open_recording(folder)).coefficients
    expected = calibrate(recording).coefficients
    np.testing.assert_array_equal(found.slope, expected.slope)
    np.testing.assert_array_equal(found.responsivity_std, expected.responsivity_std)


@pytest.mark.parametrize("with_darks", [True, False])
def test_the_domain_reaches_down_to_the_darks_where_there_are_any(with_darks: bool) -> None:
    bench = Bench(darks=3 if with_darks else 0)
    drawn = draw(bench, np.random.default_rng())
    found = determine(
        drawn.statistics, bench.header(), Provenance(""), Choices(darks_required=False)
    )
    lowest = drawn.statistics.fit[0 if not with_darks else -1].mean_dn.min()
    domain = found.coefficients.domain
    assert (domain.radiance[0] == 0.0) is with_darks
    assert domain.dn[0] <= lowest < domain.dn[1]
    assert (domain.dn[0] < bench.offset_mean + 4 * bench.offset_std) is with_darks
