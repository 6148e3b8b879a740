"""A camera that names its features as SFNC 1.x did, with gain and black level in raw steps."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from drivers.aravis.settings import RawSteps
from drivers.aravis.simulated_process import SimulatedCameraProcess
from drivers.errors import SettingRefusedError
from drivers.mock.world import World
from drivers.ports import CameraSettings
from tests.contracts.simulated_camera import (
    ADDRESS_WAIT_S,
    assert_mean,
    expected_dn,
    lines_of,
    lit,
)
from tests.drivers.aravis.conftest import opened

__all__ = ["lit"]

pytestmark = pytest.mark.aravis


@pytest.fixture(scope="module")
def older(model_path: Path, world_path: Path) -> Iterator[SimulatedCameraProcess]:
    with SimulatedCameraProcess(
        model_path, world_path, serial="C1", dialect="sfnc1", wait_s=ADDRESS_WAIT_S
    ) as process:
        yield process


def test_mean_follows_gain_and_black_level_in_raw_steps(
    older: SimulatedCameraProcess, lit: World, wanted: CameraSettings
) -> None:
    steps = RawSteps(gain_db=0.01, black_level_dn=0.01)
    with opened(older.address, raw_steps=steps) as camera:
        asked = replace(wanted, exposure_us=40.0, gain_db=2.5, black_level_dn=60.0)
        used = camera.configure(asked)
        assert (used.gain_db, used.black_level_dn) == pytest.approx((2.5, 60.0))
        assert_mean(lines_of(camera), expected_dn(used, (1, 1, 1)))


def test_raw_steps_of_unknown_worth_are_refused_but_for_0(
    older: SimulatedCameraProcess, wanted: CameraSettings
) -> None:
    with opened(older.address) as camera:
        assert camera.configure(wanted).gain_db == 0.0
        with pytest.raises(SettingRefusedError) as caught:
            camera.configure(replace(wanted, gain_db=3.0))
        assert caught.value.code == "raw-unit-unknown"
        assert "GainRaw" in str(caught.value)
