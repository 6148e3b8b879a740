"""`calibrate --model`: a model's departures are taken out, and carried by the set."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from calib.forward.effects.nonlinearity import Nonlinearity
from calib.forward.model import Model
from calib.radiometric.coefficients.coefficient_set import CoefficientSet
from calib.recording.open import open_recording
from service.cli.simulated_recording import simulate_recording
from service.plan.model import Plan
from tests.service.cli.answers import Ran

Run = Callable[..., Ran]
BENT = Nonlinearity(2e-5)


@pytest.fixture(scope="module")
def bent_recording(tmp_path_factory: pytest.TempPathFactory, plan_file: Path) -> Path:
    """Of the demo camera with an output stage that bends."""
    out = tmp_path_factory.mktemp("bent") / "bent.h5"
    model, plan = Model.preset("demo").with_effect(BENT), Plan.load(plan_file)
    simulate_recording(model, plan, out, seed=5, scenes_folder=plan_file.parent)
    return out


@pytest.fixture
def model_file(bent_recording: Path, tmp_path: Path) -> Path:
    """A model of the columns that were read out, which bends as the camera does."""
    header = open_recording(bent_recording).header
    links = Model.preset("demo").with_effect(BENT).effects
    Model(header.camera, header.source, links).save(tmp_path / "amended.toml")
    return tmp_path / "amended.toml"


def test_the_set_is_that_of_a_straight_camera_and_straightens_lines(
    run: Run, bent_recording: Path, model_file: Path, tmp_path: Path
) -> None:
    ran = run("calibrate", bent_recording, "--out", tmp_path / "set.h5", "--model", model_file,
              "--report", tmp_path / "page.html", "--json", "-")  # fmt: skip
    assert ran.status == 0, ran.stderr
    assert ran.json["departures"] == {"nonlinearity": {"beta_per_dn": BENT.beta_per_dn}}
    plain = run("calibrate", bent_recording, "--out", tmp_path / "plain.h5", "--json", "-")
    assert plain.json["departures"] is None
    assert ran.json["reduced_chi_squared"] < plain.json["reduced_chi_squared"]
    page = (tmp_path / "page.html").read_text()
    assert "nonlinearity was taken out of the recording" in page
    assert "nonlinearity (beta_per_dn 2e-05)" in page
    found = CoefficientSet.load(tmp_path / "set.h5")
    assert found.departures is not None
    truth = Model.preset("demo").truth()
    seen = slice(400, 656)
    slope = truth.vignette[seen] * truth.responsivity[seen]
    z = (found.slope - slope) / np.hypot(found.slope_std, slope * found.scale_relative_std)
    # Certified radiances are within 0.3 % of the lamps', of which the levels' scatter tells.
    assert np.abs(found.slope / slope - 1.0).mean() < 0.005
    assert np.sqrt(np.mean((z - z.mean()) ** 2)) < 2.0


def test_what_is_taken_out_is_said_on_the_screen(
    run: Run, bent_recording: Path, model_file: Path, tmp_path: Path
) -> None:
    ran = run("calibrate", bent_recording, "--out", tmp_path / "set.h5", "--model", model_file)
    assert ran.status == 0, ran.stderr
    assert "taken out" in ran.stdout
    assert "nonlinearity" in ran.stdout
