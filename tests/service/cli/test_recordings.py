"""simulate, import, export, calibrate, apply: from file to file."""

import json
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest

from calib.radiometric.coefficients.coefficient_set import CoefficientSet
from calib.recording.open import open_recording
from tests.service.cli.a_recording import PLAN
from tests.service.cli.answers import Ran

Run = Callable[..., Ran]


@pytest.fixture
def set_file(run: Run, recording_file: Path, tmp_path: Path) -> Path:
    assert run("calibrate", recording_file, "--out", tmp_path / "set.h5").status == 0
    return tmp_path / "set.h5"


@pytest.mark.parametrize("name", ["rec.h5", "rec"])
def test_one_seed_gives_one_recording_in_a_file_or_a_folder(
    run: Run, plan_file: Path, tmp_path: Path, recording_file: Path, name: str
) -> None:
    out = tmp_path / name
    ran = run("simulate", "demo", plan_file, "--out", out, "--seed", 17, "--json", "-")
    assert ran.status == 0
    assert ran.json["blocks"] == 9
    made, same = open_recording(out), open_recording(recording_file)
    for block in same.header.blocks:
        np.testing.assert_array_equal(
            np.concatenate(list(made.frames(block.block))),
            np.concatenate(list(same.frames(block.block))),
        )
    assert made.header.camera.serial == "D0001"
    assert made.header.camera.columns == 256


def test_another_seed_gives_another_recording(
    run: Run, plan_file: Path, tmp_path: Path, recording_file: Path
) -> None:
    run("simulate", "demo", plan_file, "--out", tmp_path / "rec.h5", "--seed", 18)
    made, other = open_recording(tmp_path / "rec.h5"), open_recording(recording_file)
    assert not np.array_equal(next(made.frames("000")), next(other.frames("000")))


def test_a_model_file_does_as_well_as_a_preset(run: Run, plan_file: Path, tmp_path: Path) -> None:
    from calib.forward.model import Model

    Model.preset("demo").save(tmp_path / "model.toml")
    ran = run("simulate", tmp_path / "model.toml", plan_file, "--out", tmp_path / "rec.h5")
    assert ran.status == 0


def test_apply_leaves_capped_darks_out_and_says_so(
    run: Run, recording_file: Path, tmp_path: Path, set_file: Path
) -> None:
    blocks = open_recording(recording_file).header.blocks
    darks = [b.block for b in blocks if b.kind == "dark"]
    ran = run("apply", set_file, recording_file, "--out", tmp_path / "a.h5", "--json", "-")
    assert ran.status == 0
    assert ran.json["left_out"] == darks
    assert ran.json["blocks"] == [b.block for b in blocks if b.kind != "dark"]
    assert ran.json["flags"]["below_black"] == 0
    told = run("apply", set_file, recording_file, "--out", tmp_path / "b.h5")
    assert f"{len(darks)} capped darks were left out" in told.stdout


@pytest.mark.parametrize(
    ("change", "code"),
    [
        (('"Mono12"', '"Mono8"'), "plan-does-not-fit-model"),
        (("columns = 256", "columns = 700"), "plan-does-not-fit-model"),
        (("lines = 64", "lines = 65"), "plan-invalid"),
        (("band =", "bond ="), "plan-invalid"),
    ],
)
def test_a_plan_that_does_not_fit_leaves_nothing_behind(
    run: Run, tmp_path: Path, change: tuple[str, str], code: str
) -> None:
    (tmp_path / "plan.toml").write_text(PLAN.replace(*change, 1))
    ran = run("simulate", "demo", tmp_path / "plan.toml", "--out", tmp_path / "r.h5", "--json", "-")
    assert (ran.status, ran.error_code) == (1, code)
    assert [path.name for path in tmp_path.iterdir()] == ["plan.toml"]


def test_export_and_import_keep_the_content(run: Run, recording_file: Path, tmp_path: Path) -> None:
    folder, back = tmp_path / "folder", tmp_path / "back.h5"
    assert run("export", recording_file, "--out", folder, "--format", "tif").status == 0
    assert (folder / "frames" / "000.tif").is_file()
    ran = run("import", folder, "--out", back, "--json", "-")
    assert ran.status == 0
    assert ran.json["recording"] == str(back)
    assert open_recording(back).digest() == open_recording(recording_file).digest()


@pytest.mark.parametrize(
    ("options", "verdict"),
    [((), "none"), (("--ignore-monitor",), "ignored")],
    ids=["as is", "told"],
)
def test_a_monitor_is_ignored_where_one_says_so(
    run: Run, recording_file: Path, tmp_path: Path, options: tuple[str, ...], verdict: str
) -> None:
    assert run("calibrate", recording_file, "--out", tmp_path / "set.h5", *options).status == 0
    told = CoefficientSet.load(tmp_path / "set.h5").provenance.parameters
    assert told["monitor"] == verdict


def test_calibrate_answers_as_the_contract_says(
    run: Run, recording_file: Path, tmp_path: Path
) -> None:
    out, report = tmp_path / "set.h5", tmp_path / "report.html"
    ran = run("calibrate", recording_file, "--out", out, "--report", report, "--json", "-")
    assert ran.status == 0
    for key in (
        "coefficient_set", "columns", "valid_columns", "vignette_order", "axis_column",
        "edge_fall_percent", "mean_dark_offset_dn", "cov_before_percent", "cov_after_percent",
        "responsivity_at_axis", "reduced_chi_squared", "warnings",
    ):  # fmt: skip
        assert key in ran.json
    assert set(ran.json["mean_dark_offset_dn"]) == {"regression", "capped", "capped_raw"}
    assert CoefficientSet.load(out).id == ran.json["coefficient_set"]
    assert isinstance(ran.json["axis_column"], int)
    assert ran.json["cov_after_percent"] < ran.json["cov_before_percent"]
    assert report.read_text().lstrip().startswith("<!doctype html")


def test_calibrating_again_is_the_same_set_and_another_one_is_never_overwritten(
    run: Run, recording_file: Path, tmp_path: Path, set_file: Path
) -> None:
    assert run("calibrate", recording_file, "--out", set_file).status == 0
    before = set_file.read_bytes()
    radiances = tmp_path / "radiances.csv"
    radiances.write_text("level,radiance\n2,10\n4,20\n")
    ran = run(
        "calibrate", recording_file, "--out", set_file, "--radiances", radiances, "--json", "-"
    )
    assert (ran.status, ran.error_code) == (1, "output-exists")
    assert set_file.read_bytes() == before


def test_a_report_that_is_there_is_kept(run: Run, recording_file: Path, tmp_path: Path) -> None:
    report, found = tmp_path / "r.html", tmp_path / "set.h5"
    report.write_text("mine")
    ran = run("calibrate", recording_file, "--out", found, "--report", report, "--json", "-")
    assert (ran.status, ran.error_code) == (1, "output-exists")
    assert report.read_text() == "mine"
    assert not found.exists()


def test_set_and_report_are_written_both_or_neither(
    run: Run, recording_file: Path, tmp_path: Path
) -> None:
    report, found = tmp_path / "r.html", tmp_path / "set.h5"
    found.write_text("somebody else's")
    ran = run("calibrate", recording_file, "--out", found, "--report", report, "--json", "-")
    assert (ran.status, ran.error_code) == (1, "output-exists")
    assert found.read_text() == "somebody else's"
    assert not report.exists()


def test_radiances_of_a_table_go_before_those_of_the_blocks(
    run: Run, recording_file: Path, tmp_path: Path, set_file: Path
) -> None:
    radiances, out = tmp_path / "radiances.csv", tmp_path / "half.h5"
    radiances.write_text("level, radiance\n2, 10.05\n4, 20.1\n")
    assert run("calibrate", recording_file, "--out", out, "--radiances", radiances).status == 0
    ratio = CoefficientSet.load(out).responsivity / CoefficientSet.load(set_file).responsivity
    np.testing.assert_allclose(ratio, 2.0, rtol=1e-6)


@pytest.mark.parametrize(
    "text",
    ["", "level,radiance\n", "level\n2\n", "level,radiance\n2,x\n", "level,radiance\n2,1\n2,1\n"],
)
def test_a_bad_table_of_radiances_is_one_sentence(
    run: Run, recording_file: Path, tmp_path: Path, text: str
) -> None:
    (tmp_path / "r.csv").write_text(text)
    ran = run(
        "calibrate", recording_file, "--out", tmp_path / "set.h5",
        "--radiances", tmp_path / "r.csv", "--json", "-",
    )  # fmt: skip
    assert (ran.status, ran.error_code) == (1, "radiances-unreadable")
    assert not (tmp_path / "set.h5").exists()


def test_apply_writes_radiance_uncertainty_and_flags(
    run: Run, recording_file: Path, tmp_path: Path, set_file: Path
) -> None:
    out = tmp_path / "radiance.h5"
    ran = run("apply", set_file, recording_file, "--out", out, "--block", "003", "--json", "-")
    assert ran.status == 0
    assert ran.json["blocks"] == ["003"]
    block = next(b for b in open_recording(recording_file).header.blocks if b.block == "003")
    with h5py.File(out) as file:
        radiance, std = file["blocks/003/radiance"][()], file["blocks/003/std"][()]
    assert radiance.shape == (64, 256)
    assert block.radiance is not None
    expected_std = std.mean() / np.sqrt(radiance.size)
    assert abs(radiance.mean() - block.radiance) < 5 * expected_std + 0.02 * block.radiance


@pytest.mark.parametrize(
    ("window", "transmittance"),
    [
        (("--transmittance", 0.5, 0.01), 0.5),
        (("--window", "destiny-red"), 0.980),
        (("--window", "destiny-nir"), 0.934),
    ],
)
def test_a_window_is_divided_out(
    run: Run, recording_file: Path, set_file: Path, window: tuple[object, ...], transmittance: float
) -> None:
    radiance = {}
    for name, more in (("without", ()), ("with", window)):
        out = set_file.with_name(f"{name}.h5")
        frames = (recording_file, "--block", "003")
        assert run("apply", set_file, *frames, "--out", out, *more).status == 0
        with h5py.File(out) as file:
            radiance[name] = file["blocks/003/radiance"][()]
    ratio = radiance["without"] / radiance["with"]
    np.testing.assert_allclose(ratio, transmittance, rtol=1e-5)


@pytest.mark.parametrize(
    "window",
    [("--window", "glass"), ("--window", "destiny-nir", "--transmittance", 0.9, 0.01)],
)
def test_a_window_that_is_not_known_or_two_of_them_are_wrong_usage(
    run: Run, window: tuple[object, ...]
) -> None:
    assert run("apply", "set.h5", "lines.npy", "--out", "out.h5", *window).status == 2


def test_bare_lines_are_corrected_as_those_of_the_recording(
    run: Run, recording_file: Path, tmp_path: Path, set_file: Path
) -> None:
    recording = open_recording(recording_file)
    block = [b for b in recording.header.blocks if b.kind == "flat"][1]
    np.save(tmp_path / "lines.npy", np.concatenate(list(recording.frames(block.block))))
    whole, bare = tmp_path / "whole.h5", tmp_path / "bare.h5"
    run("apply", set_file, recording_file, "--out", whole)
    ran = run(
        "apply", set_file, tmp_path / "lines.npy", "--out", bare,
        "--exposure-us", block.exposure_us, "--json", "-",
    )  # fmt: skip
    assert ran.status == 0
    assert any("does not say its camera" in note for note in ran.json["notes"])
    with h5py.File(whole) as one, h5py.File(bare) as other:
        np.testing.assert_array_equal(
            one[f"blocks/{block.block}/radiance"][()], other["blocks/lines/radiance"][()]
        )


def test_what_apply_cannot_do_it_says_in_one_sentence(
    run: Run, recording_file: Path, tmp_path: Path, set_file: Path
) -> None:
    np.save(tmp_path / "lines.npy", np.zeros((4, 256), np.uint16))
    np.save(tmp_path / "wide.npy", np.zeros((4, 300), np.uint16))
    np.save(tmp_path / "real.npy", np.zeros((4, 256)))
    cases: dict[str, tuple[object, ...]] = {
        "exposure-missing": (tmp_path / "lines.npy",),
        "exposure-known": (recording_file, "--exposure-us", 10),
        "wrong-columns": (tmp_path / "wide.npy", "--exposure-us", 10),
        "wrong-shape": (tmp_path / "real.npy", "--exposure-us", 10),
        "no-such-block": (recording_file, "--block", "nobody"),
        "not-found": (tmp_path / "nowhere.npy", "--exposure-us", 10),
    }
    for code, arguments in cases.items():
        ran = run("apply", set_file, *arguments, "--out", tmp_path / "out.h5", "--json", "-")
        assert (ran.status, ran.error_code) == (1, code)
        assert len(ran.stderr.strip().splitlines()) == 1
    assert not (tmp_path / "out.h5").exists()


def test_the_answer_goes_to_a_file_whole(run: Run, recording_file: Path, tmp_path: Path) -> None:
    answer = tmp_path / "answer.json"
    ran = run("calibrate", recording_file, "--out", tmp_path / "set.h5", "--json", answer)
    assert ran.status == 0
    assert json.loads(answer.read_text())["columns"] == 256
    assert "coefficient set" in ran.stdout
