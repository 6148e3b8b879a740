"""From a monochromator scan and the lamps' spectra to a radiance scale, by commands."""

import hashlib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from numpy.random import default_rng

from calib.radiometric.coefficients.coefficient_set import CoefficientSet
from calib.radiometric.spectral.spectral_response import SpectralResponse
from calib.radiometric.spectral.spectral_response_scan import SpectralScan
from calib.recording.header import Block, CameraHeader, RecordingHeader, SourceHeader
from service.cli.radiance_arguments import level_radiances
from tests.calib.radiometric.example_scan import ExampleScan
from tests.service.cli.answers import Ran

Run = Callable[..., Ran]
LAMPS = "wavelength_nm,l1,l2,l3,l4,l1_std\n700,1,2,3,4,0.02\n1000,1,2,3,4,0.02\n"
LAMP_1_SHARED = (0.02 / 3 * 0.02 / 10) ** 0.5
"""Its 2 % are in both levels, which have 3 and 10 times its radiance."""


@dataclass(frozen=True)
class At:
    """Where a test calibrates."""

    run: Run
    folder: Path
    recording: Path

    def calibrate(self, response: Path, out: str, *more: object) -> Ran:
        """Calibrate with `lamps.csv` and a response."""
        return self.run(
            "calibrate", self.recording, "--out", self.folder / out, "--lamp-spectra",
            self.folder / "lamps.csv", "--spectral-response", response, *more, "--json", "-",
        )  # fmt: skip


@pytest.fixture
def at(run: Run, tmp_path: Path, recording_file: Path) -> At:
    return At(run, tmp_path, recording_file)


@pytest.fixture
def scan(tmp_path: Path) -> Path:
    return ExampleScan(shift_nm_at_4_deg=-1.5).write(tmp_path / "scan", default_rng(5))


@pytest.fixture
def response(run: Run, scan: Path, tmp_path: Path) -> Path:
    assert run("spectral-response", scan, "--out", tmp_path / "response.csv").status == 0
    return tmp_path / "response.csv"


@pytest.fixture
def lamps(tmp_path: Path) -> Path:
    (tmp_path / "lamps.csv").write_text(LAMPS)
    return tmp_path / "lamps.csv"


def test_a_scan_becomes_a_response_with_its_figures(run: Run, scan: Path, tmp_path: Path) -> None:
    out, figure = tmp_path / "response.csv", tmp_path / "response.svg"
    ran = run("spectral-response", scan, "--out", out, "--figure", figure, "--json", "-")
    assert ran.status == 0
    told = ran.json
    expected = SpectralScan.load(scan).at_angle(0.0)
    back = SpectralResponse.load(out)
    np.testing.assert_array_equal(back.response, expected.response)
    np.testing.assert_array_equal(back.std, expected.std)
    for name, truth in (("centre_wavelength_nm", 835.0), ("fwhm_nm", 110.0)):
        assert abs(told[name]["value"] - truth) < 5 * told[name]["std"] < 5
    assert abs(told["out_of_band_fraction"]["value"]) < 0.02
    assert 0 < told["drift"]["largest"] < 0.04
    assert [each["angle_deg"] for each in told["drift"]["rms_by_angle"]] == [-4, -2, 0, 2, 4]
    assert [each["angle_deg"] for each in told["angles"]] == [-4, -2, 2, 4]
    assert any("angle of incidence" in warning for warning in told["warnings"])
    assert figure.read_text().lstrip().startswith("<?xml")
    shown = run("spectral-response", scan, "--out", tmp_path / "again.csv")
    assert "FWHM" in shown.stdout


def test_a_band_that_the_scan_does_not_cover_has_a_response_but_no_width(
    run: Run, scan: Path, tmp_path: Path
) -> None:
    path = scan / "scan.csv"
    head, *rows = path.read_text().splitlines()
    kept = [row for row in rows if float(row.split(",")[0]) < 850]
    path.write_text("\n".join([head, *kept]) + "\n")
    ran = run("spectral-response", scan, "--out", tmp_path / "response.csv", "--json", "-")
    assert ran.status == 0
    assert ran.json["fwhm_nm"] is None
    assert ran.json["out_of_band_fraction"] is None
    assert any("scan further" in warning for warning in ran.json["warnings"])


@pytest.mark.parametrize("of_camera", ["response.csv", "scan"])
def test_spectra_give_the_scale_that_their_band_radiance_has(
    at: At, lamps: Path, response: Path, of_camera: str
) -> None:
    ran = at.calibrate(at.folder / of_camera, "set.h5", "--certificate-std", 0.011)
    assert ran.status == 0
    bandwidth = SpectralResponse.load(response).bandwidth_nm
    table = at.folder / "table.csv"
    table.write_text(f"level,radiance\n2,{3 * bandwidth.value}\n4,{10 * bandwidth.value}\n")
    by_table = at.run(
        "calibrate", at.recording, "--out", at.folder / "t.h5", "--radiances", table, "--json", "-"
    )
    ours, theirs = ran.json["responsivity_at_axis"], by_table.json["responsivity_at_axis"]
    assert ours["value"] == pytest.approx(theirs["value"], rel=0.01)  # the levels' weights differ
    assert ours["unit"] == "DN / (W m-2 sr-1 µs)"
    made = CoefficientSet.load(at.folder / "set.h5")
    rows = {row.quantity: row for row in made.budget.rows}
    of_response = rows["spectral response in the band radiance"]
    assert (of_response.kind, of_response.scope) == ("B", "common")
    assert of_response.value == pytest.approx(bandwidth.std / bandwidth.value, rel=0.01)
    assert rows["certified radiance"].value == pytest.approx(np.hypot(0.011, LAMP_1_SHARED))
    assert rows["radiance of single levels"].kind == "B"
    assert made.budget.combined_common == pytest.approx(made.scale_relative_std)


def test_provenance_names_both_files_by_their_digests(
    at: At, lamps: Path, scan: Path, response: Path
) -> None:
    def parameters(of_camera: Path, out: str) -> dict[str, object]:
        assert at.calibrate(of_camera, out).status == 0
        return dict(CoefficientSet.load(at.folder / out).provenance.parameters)

    by_file, by_scan = parameters(response, "a.h5"), parameters(scan, "b.h5")
    for known, path in (("lamp_spectra", lamps), ("spectral_response", response)):
        assert by_file[known] == path.name
        assert by_file[f"{known}_sha256"] == hashlib.sha256(path.read_bytes()).hexdigest()
    (scan / "photodiode.csv").write_text((scan / "photodiode.csv").read_text() + "# mended\n")
    changed = parameters(scan, "c.h5")
    assert changed["lamp_spectra_sha256"] == by_scan["lamp_spectra_sha256"]
    assert changed["spectral_response_sha256"] != by_scan["spectral_response_sha256"]


def test_without_a_certificate_the_lamps_own_uncertainty_is_all_that_is_certified(
    at: At, lamps: Path, response: Path
) -> None:
    assert at.calibrate(response, "set.h5").status == 0
    rows = CoefficientSet.load(at.folder / "set.h5").budget.rows
    certified = next(row for row in rows if row.quantity == "certified radiance")
    assert certified.value == pytest.approx(LAMP_1_SHARED)


@pytest.mark.parametrize(
    "more",
    [
        ("--lamp-spectra", "l.csv"),
        ("--spectral-response", "r.csv"),
        ("--lamp-spectra", "l.csv", "--spectral-response", "r.csv", "--radiances", "t.csv"),
        ("--lamp-spectra", "l.csv", "--spectral-response", "r.csv", "--relative"),
        ("--certificate-std", "0.01"),
    ],
)
def test_options_that_contradict_one_another_are_wrong_usage(run: Run, more: tuple[str]) -> None:
    assert run("calibrate", "recording.h5", "--out", "set.h5", *more).status == 2


BAND = "wavelength_nm,response\n800,0\n810,1\n"
ENOUGH = {"lamps.csv": LAMPS, "response.csv": BAND}


@pytest.mark.parametrize(
    ("changed", "more", "code"),
    [
        ({"lamps.csv": None}, (), "not-found"),
        ({"response.csv": None}, (), "not-found"),
        ({"lamps.csv": "wavelength_nm\n800\n"}, (), "missing-column"),
        ({"lamps.csv": LAMPS.replace("700,", "805,")}, (), "spectrum-range"),
        ({"lamps.csv": LAMPS.replace("700,1", "700,x")}, (), "bad-number"),
        ({"lamps.csv": "wavelength_nm,a\n700,1\n900,1\n"}, (), "levels-not-lamps"),
        ({"lamps.csv": LAMPS.replace("1,2,3,4", "0,0,3,4")}, (), "dark-level"),
        ({"response.csv": BAND.replace("0,1", "0,nan")}, (), "bad-number"),
        ({"response.csv": "wavelength_nm,response\n800,-1\n810,-2\n"}, (), "no-response"),
        ({}, ("--certificate-std", 1.5), "certificate-std"),
        ({}, ("--response-correlation-nm", -1), "correlation-length"),
    ],
)
def test_spectra_that_cannot_be_used_end_in_one_sentence_and_no_set(
    at: At, changed: dict[str, str | None], more: tuple[object, ...], code: str
) -> None:
    for name, text in (ENOUGH | changed).items():
        if text is not None:
            (at.folder / name).write_text(text)
    ran = at.calibrate(at.folder / "response.csv", "set.h5", *more)
    assert (ran.status, ran.error_code) == (1, code)
    assert len(ran.stderr.strip().splitlines()) == 1
    assert not (at.folder / "set.h5").exists()


@pytest.mark.parametrize(
    ("more", "code"),
    [
        (("--angle-deg", "3"), "no-such-angle"),
        (("--figure", "figure.bmp"), "figure-format"),
    ],
)
def test_a_scan_that_cannot_be_used_leaves_nothing_behind(
    run: Run, scan: Path, tmp_path: Path, more: tuple[str, ...], code: str
) -> None:
    out = tmp_path / "response.csv"
    ran = run("spectral-response", scan, "--out", out, *more, "--json", "-")
    assert (ran.status, ran.error_code) == (1, code)
    assert not out.exists()
    (scan / "reference.csv").unlink()
    ran = run("spectral-response", scan, "--out", out, "--json", "-")
    assert (ran.status, ran.error_code) == (1, "not-found")
    assert "reference.csv" in ran.stderr
    assert not out.exists()


def test_a_response_is_never_overwritten(run: Run, scan: Path, response: Path) -> None:
    before = response.read_bytes()
    ran = run("spectral-response", scan, "--out", response, "--angle-deg", 2, "--json", "-")
    assert (ran.status, ran.error_code) == (1, "output-exists")
    assert response.read_bytes() == before


@pytest.mark.parametrize(("given", "expected"), [(None, 0.03), (0.01, 0.01)])
def test_the_certificate_that_the_recording_states_counts_where_none_is_given(
    tmp_path: Path, given: float | None, expected: float
) -> None:
    for name, text in ENOUGH.items():
        (tmp_path / name).write_text(text.replace(",0.02", ",0"))
    found = level_radiances(
        RecordingHeader(
            camera=CameraHeader(columns=8, bit_depth=12),
            source=SourceHeader(kind="sphere", certificate_relative_std=0.03),
            blocks=(Block(block="000", kind="flat", exposure_us=10, level=2),),
        ),
        table=None,
        lamp_spectra=tmp_path / "lamps.csv",
        spectral_response=tmp_path / "response.csv",
        certificate_std=given,
        correlation_nm=0.0,
    )
    assert found.source is not None
    assert found.source.certificate_relative_std == pytest.approx(expected)
