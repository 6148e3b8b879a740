"""Simulated cameras, in the process or behind GigE Vision, show every departure there is."""

from pathlib import Path

import numpy as np
import pytest

from calib.forward.departure import Departure
from calib.forward.effects.catalogue import CATALOGUE
from calib.forward.model import Model
from drivers.mock.sensor import VirtualSensor
from drivers.mock.world import World
from drivers.ports import CameraSettings
from tests.calib.forward.small_sensors import SENSORS, at, fitting
from tests.calib.forward.strengths import shown

DEPARTURES = [kind for kind in CATALOGUE if issubclass(kind, Departure)]


@pytest.mark.parametrize("kind", DEPARTURES, ids=lambda kind: kind.name)
@pytest.mark.parametrize("plain", SENSORS.values(), ids=SENSORS)
def test_the_sensor_of_a_bench_draws_a_model_with_a_departure(
    kind: type[Departure], plain: Model, tmp_path: Path
) -> None:
    world = World.create(tmp_path / "world", 6)
    world.drive(0, 1.0)
    model = fitting(plain, shown(kind))
    rows = model.camera.rows
    settings = CameraSettings(
        exposure_us=60.0,
        line_period_us=100.0,
        frame_lines=20 if rows is None else 1,
        n_columns=model.camera.columns,
        n_rows=rows,
    )
    dn = VirtualSensor(model, world, np.random.default_rng(3)).expose(settings, started_s=2.0)
    world.close()
    same = at(settings.frame_lines, exposure_us=60.0, started_s=2.0, lamps=(1.0,) + (0.0,) * 5)
    wanted = model.draw(same, np.random.default_rng(3)).dn
    assert np.array_equal(dn, wanted if rows is None else wanted[0])
