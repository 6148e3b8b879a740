"""The presets show the figures that they stand for."""

import numpy as np
import pytest

from calib.arrays import RawLines
from calib.forward.conditions import Conditions
from calib.forward.effects.full_well import FullWell
from calib.forward.model import Model
from calib.forward.model_file import preset_names

AGCAM = {
    "agcam-nir": {"prnu": 0.0328, "noise": 1.0, "saturates": 6},
    "agcam-red": {"prnu": 0.0812, "noise": 2.0, "saturates": 5},
}
agcam = pytest.mark.parametrize(("name", "figures"), AGCAM.items(), ids=AGCAM)


def lines(model: Model, level: int, exposure_us: float, n_lines: int = 100) -> RawLines:
    period_us = model.camera.line_period_us
    assert period_us is not None
    at = Conditions.steady(
        n_lines, exposure_us=exposure_us, line_period_us=period_us, lamps=(1.0,) * level
    )
    return model.draw(at, np.random.default_rng(level)).dn


@agcam
def test_agcam_has_the_papers_sensor_and_optics(name: str, figures: dict[str, float]) -> None:
    model = Model.preset(name)
    truth = model.truth()
    assert (model.camera.columns, model.camera.bit_depth) == (6144, 8)
    assert model.camera.line_period_us == 1400.0
    assert np.argmax(truth.vignette) == truth.axis_column == 3303
    assert 1 - truth.vignette.min() == pytest.approx(0.55, abs=0.005)
    assert np.all(np.diff(truth.vignette[:3304]) > 0)
    assert np.all(np.diff(truth.vignette[3303:]) < 0)
    scatter = truth.responsivity.std() / truth.responsivity.mean()
    assert scatter == pytest.approx(figures["prnu"], rel=0.03)


@agcam
def test_agcam_has_the_papers_offsets_few_of_them_negative(
    name: str, figures: dict[str, float]
) -> None:
    offset = Model.preset(name).truth().dark_offset_dn
    assert offset.mean() == pytest.approx(3.5, abs=0.01)
    assert offset.min() == pytest.approx(-9.0, abs=0.5)
    assert offset.max() == pytest.approx(7.0, abs=0.5)
    assert 0 < np.mean(offset < 0) < 0.01


@agcam
@pytest.mark.parametrize("exposure_us", [100.0, 200.0, 300.0, 400.0, 500.0])
def test_agcams_flat_field_is_unsaturated_and_as_noisy_as_the_paper_says(
    name: str, figures: dict[str, float], exposure_us: float
) -> None:
    flat = lines(Model.preset(name), 1, exposure_us)
    assert flat.max() < 255
    assert np.median(flat.std(0, ddof=1)) < figures["noise"]


@agcam
def test_agcams_axis_saturates_at_the_papers_lamp_and_not_before(
    name: str, figures: dict[str, float]
) -> None:
    model, n = Model.preset(name), int(figures["saturates"])
    below = lines(model, n - 1, 100.0)[:, 3253:3354]
    above = lines(model, n, 100.0)[:, 3303]
    assert below[:, 50].max() < 255
    assert np.median(below) < 240
    assert np.all(above == 255)


@pytest.mark.parametrize("name", preset_names())
def test_the_well_of_a_preset_lies_beyond_its_codes(name: str) -> None:
    model = Model.preset(name)
    full_well = model.effect("full_well")
    assert isinstance(full_well, FullWell)
    truth = model.truth()
    reached = full_well.electrons * truth.system_gain_dn_per_e
    assert reached > model.camera.full_scale_dn


@pytest.mark.parametrize("name", ["demo", "modern-12bit"])
def test_all_lamps_nearly_fill_the_range_of_a_modern_sensor(name: str) -> None:
    model = Model.preset(name)
    assert model.camera.line_period_us is not None
    flat = lines(model, 6, 0.8 * model.camera.line_period_us)
    assert 0.75 < flat.mean(0).max() / model.camera.full_scale_dn < 0.95
