"""`photon-transfer`: what the contract promises, of each method."""

import re
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest

from calib.forward.model import Model
from calib.recording.folder import export_folder
from calib.recording.open import open_recording
from calib.transfer.emva1288.catalogue import CATALOGUE
from service.cli.simulated_recording import simulate_recording
from service.plan.model import Plan
from tests.service.cli.answers import Ran

Run = Callable[..., Ran]

PLAN = """
name = "two exposures and more"
lines = 128
frame_lines = 32

[sweep]
type = "exposure"
exposures_us = [10.0, 20.0, 30.0, 40.0, 80.0, 120.0]
level = 6

[camera]
line_period_us = 200.0
pixel_format = "Mono12"
columns = 256
first_column = 400
"""
MAPS = ("system_gain_dn_per_e", "bias_dn", "photoelectrons", "read_noise_variance_dn2")
TRUTH = Model.preset("demo").truth()


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("transfer") / "rec.h5"
    simulate_recording(
        Model.preset("demo"), Plan.loads(PLAN), path, seed=None, scenes_folder=path.parent
    )
    return path


def sigmas(figure: dict[str, float], truth: float) -> float:
    """Return how many standard uncertainties a figure is off."""
    return (figure["value"] - truth) / figure["std"]


def test_the_curve_answers_gain_noise_and_every_emva_figure(run: Run, recording: Path) -> None:
    ran = run("photon-transfer", recording, "--json", "-")
    assert ran.status == 0, ran.stderr
    assert ran.json["method"] == "ptc"
    gain = TRUTH.system_gain_dn_per_e
    assert abs(sigmas(ran.json["system_gain_dn_per_e"], gain)) < 5
    assert abs(sigmas(ran.json["read_noise_e"], TRUTH.read_noise_e)) < 5
    for figure in CATALOGUE:
        known = ran.json[figure.name]
        assert set(known) >= {"value", "std"}
        assert (known["value"] is None) == ("reason" in known)
    assert ran.json["emva1288"]["method"].startswith("EMVA Standard 1288")
    assert abs(sigmas(ran.json["emva1288"]["system_gain_dn_per_e"], gain)) < 5


def test_a_sheet_for_people_and_one_for_programs(run: Run, recording: Path, tmp_path: Path) -> None:
    page, xml = tmp_path / "sheet.html", tmp_path / "sheet.xml"
    ran = run("photon-transfer", recording, "--report", page, "--data-sheet", xml, "--json", "-")
    assert ran.status == 0, ran.stderr
    written = ran.json["written"]
    assert (written["report"], written["data_sheet"], written["maps"]) == (
        str(page),
        str(xml),
        None,
    )
    text = page.read_text("utf-8")
    assert "<svg" in text
    assert not re.search(r"(src|href)=.http", text)
    assert "<results>" in xml.read_text("utf-8")


@pytest.mark.parametrize("method", ["sanuc", "s3nuc"])
def test_two_exposures_give_maps(run: Run, recording: Path, tmp_path: Path, method: str) -> None:
    maps = tmp_path / "maps.h5"
    ran = run("photon-transfer", recording, "--method", method, "--out", maps, "--json", "-")
    assert ran.status == 0, ran.stderr
    assert ran.json["method"] == method
    assert abs(sigmas(ran.json["system_gain_dn_per_e"], TRUTH.system_gain_dn_per_e)) < 5
    with h5py.File(maps) as file:
        for name in (
            "system_gain_dn_per_e",
            "bias_dn",
            "photoelectrons",
            "read_noise_variance_dn2",
        ):
            assert file[name].shape == file[f"{name}_std"].shape == (256,)
            assert np.isfinite(file[name][()]).any()


def test_maps_come_beside_the_curve_where_they_are_asked_for(
    run: Run, recording: Path, tmp_path: Path
) -> None:
    ran = run("photon-transfer", recording, "--out", tmp_path / "maps.h5", "--json", "-")
    assert ran.status == 0, ran.stderr
    assert (ran.json["method"], ran.json["two_exposures"]["method"]) == ("ptc", "sanuc")
    assert (tmp_path / "maps.h5").is_file()


def test_sanuc_says_that_it_needs_an_exposure_and_twice_of_it(
    run: Run, recording_file: Path, tmp_path: Path
) -> None:
    maps = tmp_path / "maps.h5"
    ran = run(
        "photon-transfer", recording_file, "--method", "sanuc", "--out", maps, "--json", "-"
    )  # 10, 40 and 90 µs
    assert (ran.status, ran.error_code) == (1, "not-doubled")
    assert not maps.exists()


def test_maps_and_sheets_are_written_all_or_none(
    run: Run, recording_file: Path, tmp_path: Path
) -> None:
    sheet, maps = tmp_path / "sheet.xml", tmp_path / "maps.h5"
    ran = run("photon-transfer", recording_file, "--data-sheet", sheet, "--out", maps)
    assert ran.status == 1  # no exposure is twice another
    assert not sheet.exists()
    assert not maps.exists()


def test_sums_alone_give_the_curve_and_say_what_they_do_not_give(
    run: Run, recording: Path, tmp_path: Path
) -> None:
    folder = tmp_path / "sums"
    opened = open_recording(recording)
    export_folder(opened, folder)
    rows = ["block,samples,mean_dn,variance_dn2"]
    for block in opened.header.blocks:
        dn = np.concatenate(list(opened.frames(block.block)))
        rows.append(f"{block.block},{dn.size},{dn.mean()},{dn.var(axis=0, ddof=1).mean()}")
        (folder / "frames" / f"{block.block}.npy").unlink()
    (folder / "frames").rmdir()
    (folder / "statistics.csv").write_text("\n".join(rows))
    ran = run("photon-transfer", folder, "--json", "-")
    assert ran.status == 0, ran.stderr
    assert ran.json["system_gain_dn_per_e"]["value"] == pytest.approx(0.15, rel=0.1)
    assert ran.json["prnu_percent"]["value"] is None
    assert ran.json["prnu_percent"]["reason"]


def test_without_darks_there_is_no_sheet_to_write(
    run: Run, recording: Path, tmp_path: Path
) -> None:
    folder, page = tmp_path / "rec", tmp_path / "sheet.html"
    export_folder(open_recording(recording), folder)
    lines = (folder / "conditions.csv").read_text().splitlines()
    kept = [line for line in lines if ",dark," not in line]
    (folder / "conditions.csv").write_text("\n".join(kept))
    for line in set(lines) - set(kept):
        (folder / "frames" / f"{line.partition(',')[0]}.npy").unlink()
    ran = run("photon-transfer", folder, "--report", page, "--json", "-")
    assert (ran.status, ran.error_code) == (1, "no-data-sheet")
    assert not page.exists()
    ran = run("photon-transfer", folder, "--json", "-")
    assert ran.status == 0, ran.stderr
    assert ran.json["prnu_percent"]["value"] is None


def test_a_sheet_of_another_method_is_wrong_usage(run: Run, recording: Path) -> None:
    assert run("photon-transfer", recording, "--method", "sanuc", "--report", "x.html").status == 2
    assert run("photon-transfer", recording, "--data-sheet", "x.txt").status == 2
