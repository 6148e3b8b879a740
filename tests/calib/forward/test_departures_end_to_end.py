"""Every departure of the catalogue lives in a model file and in a simulated recording."""

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from calib.forward.departure import Departure
from calib.forward.effects.catalogue import CATALOGUE
from calib.forward.model import Model
from calib.forward.simulate import simulate
from calib.recording.header import Block
from tests.calib.forward.small_sensors import SENSORS, fitting
from tests.calib.forward.strengths import neutral, shown

BLOCKS = [
    Block(block="0", kind="dark", exposure_us=80.0, lines=9, sensor_temperature_c=30.0),
    Block(block="1", kind="flat", exposure_us=20.0, level=2, lines=9),
    Block(block="2", kind="flat", exposure_us=80.0, level=6, lines=9, sensor_temperature_c=35.0),
]
departures = pytest.mark.parametrize(
    "kind", [k for k in CATALOGUE if issubclass(k, Departure)], ids=lambda kind: kind.name
)


def simulated(model: Model, seed: int) -> list[NDArray[np.unsignedinteger]]:
    rng = np.random.default_rng(seed)
    drawn = simulate(model, BLOCKS, rng, frame_lines=4)
    return [np.concatenate(list(frames)) for _, frames in drawn]


@departures
@pytest.mark.parametrize("sensor", SENSORS)
def test_a_saved_model_simulates_what_the_model_does_and_shows_its_departure(
    kind: type[Departure], sensor: str, tmp_path: Path
) -> None:
    plain = SENSORS[sensor]
    model = fitting(plain, shown(kind))
    model.save(tmp_path / "model.toml")
    again = Model.load(tmp_path / "model.toml")
    assert again == model
    strong = simulated(model, 1)
    for one, two in zip(strong, simulated(again, 1), strict=True):
        assert one.dtype == np.uint16
        assert one.max() <= plain.camera.full_scale_dn
        assert np.array_equal(one, two)
    absent = neutral(kind)
    assert absent is not None
    without = simulated(fitting(plain, absent), 1)
    assert any(not np.array_equal(one, two) for one, two in zip(strong, without, strict=True))
