"""A real 12-bit CCD of which sums survive: its response bends, and charge that repels does not."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from calib.diagnosis.sums.diagnose import SumsExamination, diagnose_sums
from calib.forward.model import Model
from calib.recording.folder_recording import FolderRecording
from examples.photon_transfer import CCD12, folder_of_sums
from service.cli.app import app

TABLE = CCD12 / "ptc_table.csv"
pytestmark = [
    pytest.mark.shared,
    pytest.mark.skipif(not TABLE.exists(), reason="needs the reference material"),
]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return folder_of_sums(TABLE, tmp_path_factory.mktemp("ccd12") / "sums")


@pytest.fixture(scope="module")
def found(folder: Path) -> SumsExamination:
    return diagnose_sums(FolderRecording(folder))


def test_the_response_bends_and_nothing_else_is_named(found: SumsExamination) -> None:
    (finding,) = found.diagnosis.findings
    assert finding.effect.name == "nonlinearity"
    assert [c.effect for c in finding.candidates] == ["nonlinearity"]
    assert finding.significance_sigma > 8.0
    beta = finding.parameters["beta_per_dn"].value
    # Variance over mean falls as 1 - 3 beta s. Of the table alone, between two stretches:
    with TABLE.open(newline="") as file:
        rows = [{k: float(v) for k, v in row.items()} for row in csv.DictReader(file)]
    signal = np.array([r["mean_bright_DN"] - r["mean_dark_DN"] for r in rows])
    ratio = np.array([r["var_bright_DN2"] - r["var_dark_DN2"] for r in rows]) / signal
    low, high = (signal > 100) & (signal < 1000), (signal > 2600) & (signal < 3700)
    fall = 1.0 - ratio[high].mean() / ratio[low].mean()
    scatter = np.hypot(*(ratio[s].std(ddof=1) / ratio[s].mean() / s.sum() ** 0.5
                         for s in (low, high)))  # fmt: skip
    expected = 3.0 * beta * (signal[high].mean() - signal[low].mean())
    assert abs(fall - expected) < 4.0 * scatter
    assert fall > 4.0 * scatter


def test_brighter_fatter_is_not_called_for_and_that_is_said(found: SumsExamination) -> None:
    told = [r for r in found.diagnosis.remarks if r.startswith("brighter_fatter")]
    assert len(told) == 1
    assert "is not called for" in told[0]
    assert "adds variance, which it cannot" in told[0]


def test_variances_scatter_by_more_than_samples_allow_and_that_has_no_name(
    found: SumsExamination,
) -> None:
    rest = found.diagnosis.unexplained
    assert rest is not None
    assert rest.where.statistic == "variance"
    tau = found.fit.variance_excess.flats.relative
    assert tau > 2.0 * np.median(found.fit.sigma)
    assert f"{100 * tau:.2f} %" in rest.where.text


def test_exposures_left_out_are_foretold_better(found: SumsExamination) -> None:
    before, after = found.diagnosis.baseline, found.diagnosis.final
    assert before.dof == after.dof == 124
    # Each of 36 means: 2 ln of the ratio of what is left (0.51 % to 0.074 %) is 3.9; half of it
    # at least, since the fit of the others has its own errors.
    assert before.heldout_deviance - after.heldout_deviance > 0.5 * 36 * 3.9


def test_the_command_answers_with_page_and_model(folder: Path, tmp_path: Path) -> None:
    out = [tmp_path / name for name in ("answer.json", "page.html", "amended.toml")]
    ran = CliRunner().invoke(
        app,
        ["diagnose", str(folder), "--json", str(out[0]), "--report", str(out[1]),
         "--model-out", str(out[2])],
    )  # fmt: skip
    assert ran.exit_code == 0, ran.output
    told = json.loads(out[0].read_text())
    assert [f["effect"] for f in told["findings"]] == ["nonlinearity"]
    assert {each["effect"] for each in told["not_testable"]} >= {"cti", "line_noise", "adc_inl"}
    assert "nonlinearity" in out[1].read_text()
    model = Model.loads(out[2].read_text())
    assert model.effect("nonlinearity") is not None
