"""Every example plan, from the file to a recording that is drawn of it, and back."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from calib.forward.model import Model
from calib.radiometric.calibrate import calibrate
from calib.recording.header import SourceHeader
from calib.recording.open import open_recording
from calib.recording.protocol import Recording
from service.cli.simulated_recording import simulate_recording
from service.plan.describe import describe
from service.plan.expand import blocks, expand
from service.plan.model import Plan

PLANS = sorted((Path(__file__).parents[3] / "examples" / "plans").glob("*.toml"))
COLUMNS = 64


def model_for(plan: Plan) -> Model:
    model = Model.preset("agcam-nir" if plan.camera.bit_depth == 8 else "demo")
    if plan.source.kind == "led":
        return replace(model, source=SourceHeader(kind="led", lamps=1))
    return model


def narrow(plan: Plan) -> Plan:
    """Return the same plan for few columns, which takes no time to draw."""
    camera = plan.camera.model_copy(update={"columns": COLUMNS})
    return plan.model_copy(update={"camera": camera})


def drawn(plan: Plan, out: Path) -> Recording:
    return simulate_recording(model_for(plan), plan, out, seed=None, scenes_folder=out.parent)


@pytest.fixture(params=PLANS, ids=lambda path: path.stem)
def example(request: pytest.FixtureRequest) -> Plan:
    return Plan.load(request.param)


def test_there_are_examples():
    names = {"agcam", "exposure-sweep", "level-sweep", "factorial", "led-sweep"}
    assert {path.stem for path in PLANS} >= names


def test_every_example_is_a_plan_that_can_be_described(example: Plan):
    text = describe(example, columns=768).splitlines()
    assert len(text) == len(expand(example)) + 1
    assert all(step.line == line for step, line in zip(expand(example), text, strict=False))


@pytest.mark.parametrize("kind", ["sweep.h5", "folder"])
def test_an_example_s_blocks_come_back_from_the_recording_that_is_drawn_of_it(
    example: Plan, tmp_path: Path, kind: str
):
    plan = narrow(example)
    drawn(plan, tmp_path / kind)
    recording = open_recording(tmp_path / kind)
    assert recording.warnings == ()
    found, planned = recording.header.blocks, blocks(plan)
    for name in ("block", "kind", "exposure_us", "level", "lines"):
        assert [getattr(b, name) for b in found] == [getattr(b, name) for b in planned]
    for b, wanted in zip(found, planned, strict=True):
        assert wanted.radiance is None or b.radiance == wanted.radiance
        frames = np.concatenate(list(recording.frames(b.block)))
        assert frames.shape == (wanted.lines, COLUMNS)
    starts = [b.started_s for b in found]
    assert starts == sorted(starts)


def test_a_drawn_recording_keeps_the_plan(example: Plan, tmp_path: Path):
    plan = narrow(example)
    drawn(plan, tmp_path / "sweep.h5")
    kept = open_recording(tmp_path / "sweep.h5").provenance.plan
    assert Plan.loads(kept).digest() == plan.digest()


NOT_CALIBRATED_ALONE = {"level-sweep"}  # it has one exposure


@pytest.mark.parametrize(
    "path", [p for p in PLANS if p.stem not in NOT_CALIBRATED_ALONE], ids=lambda path: path.stem
)
def test_what_an_example_states_of_its_source_comes_through_to_the_budget(
    path: Path, tmp_path: Path
):
    plan = narrow(Plan.load(path))
    found = calibrate(drawn(plan, tmp_path / "sweep.h5"), order=2)
    stated = plan.source.certificate_relative_std
    assert found.coefficients.budget.combined_common > (stated or 0.0)
    assert found.coefficients.provenance.certificate == plan.source.certificate
    assert any("not stated" in text for text in found.warnings) == (stated is None)
