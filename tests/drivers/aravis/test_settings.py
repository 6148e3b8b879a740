"""What a camera may do that the simulated one does not: round coarsely, ignore, move, lack."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import pytest

from drivers.aravis.features import Features
from drivers.aravis.settings import SettingsWriter
from drivers.errors import SettingRefusedError
from drivers.ports import CameraSettings

pytestmark = pytest.mark.aravis

WANTED = CameraSettings(50.4, 100.0, 64, 512, pixel_format="Mono12")


@dataclass
class PaperCamera:
    """A camera on paper: features and values; `ignores` are written in vain."""

    floats: dict[str, float] = field(
        default_factory=lambda: {"ExposureTime": 20.0, "AcquisitionLineRate": 5000.0, "Gain": 0.0}
    )
    integers: dict[str, int] = field(
        default_factory=lambda: {"Width": 512, "Height": 64, "OffsetX": 0}
    )
    texts: dict[str, str] = field(
        default_factory=lambda: {"PixelFormat": "Mono8", "ExposureAuto": "Continuous"}
    )
    step: dict[str, float] = field(default_factory=dict)
    ignores: tuple[str, ...] = ()
    written: list[str] = field(default_factory=list)

    def is_feature_available(self, name: str) -> bool:
        return name in self.floats or name in self.integers or name in self.texts

    def get_device(self) -> "PaperCamera":
        return self

    def get_feature(self, name: str) -> Any:
        from drivers.aravis.gi_aravis import aravis

        node = aravis().GcFloatNode if name in self.floats else aravis().GcIntegerNode
        return node.new()

    def get_float(self, name: str) -> float:
        return self.floats[name]

    def get_float_bounds(self, name: str) -> tuple[float, float]:
        return (0.0, 1e5)

    def get_float_increment(self, name: str) -> float:
        return self.step.get(name, 2.2250738585072014e-308)

    def set_float(self, name: str, value: float) -> None:
        self.written.append(name)
        if name not in self.ignores:
            self.floats[name] = value

    def get_integer(self, name: str) -> int:
        return self.integers[name]

    def get_integer_bounds(self, name: str) -> tuple[int, int]:
        return (0, 8192)

    def get_integer_increment(self, name: str) -> int:
        return 1

    def set_integer(self, name: str, value: int) -> None:
        self.written.append(name)
        if name not in self.ignores:
            self.integers[name] = value

    def get_string(self, name: str) -> str:
        return self.texts[name]

    def set_string(self, name: str, value: str) -> None:
        self.written.append(name)
        if name not in self.ignores:
            self.texts[name] = value

    def dup_available_enumerations_as_strings(self, name: str) -> Sequence[str]:
        return {"PixelFormat": ("Mono8", "Mono12"), "ExposureAuto": ("Off", "Continuous")}[name]


def applied(camera: PaperCamera, wanted: CameraSettings = WANTED) -> CameraSettings:
    return SettingsWriter(Features(camera, "camera on paper")).apply(wanted)  # type: ignore[arg-type]


def test_reads_back_what_it_wrote() -> None:
    assert applied(PaperCamera()) == WANTED


def test_exposure_is_rounded_to_the_step_and_said_so() -> None:
    assert applied(PaperCamera(step={"ExposureTime": 1.0})).exposure_us == 50.0


@pytest.mark.parametrize(
    ("feature", "wanted", "got"),
    [
        ("ExposureTime", "50.4", "20"),
        ("AcquisitionLineRate", "10000", "5000"),
        ("PixelFormat", "Mono12", "Mono8"),
        ("ExposureAuto", "Off", "Continuous"),
    ],
)
def test_setting_that_does_not_stick_is_refused_with_both_values(
    feature: str, wanted: str, got: str
) -> None:
    with pytest.raises(SettingRefusedError) as caught:
        applied(PaperCamera(ignores=(feature,)))
    assert caught.value.code == "setting-not-taken"
    assert all(word in str(caught.value) for word in (feature, wanted, got))


def test_setting_that_a_later_one_moves_is_refused() -> None:
    class Moving(PaperCamera):
        def set_float(self, name: str, value: float) -> None:
            super().set_float(name, value)
            if name == "Gain":
                self.floats["ExposureTime"] = 10.0

    with pytest.raises(SettingRefusedError) as caught:
        applied(Moving())
    assert "ExposureTime" in str(caught.value)


def test_a_region_that_a_later_setting_moves_is_refused() -> None:
    class Moving(PaperCamera):
        def set_float(self, name: str, value: float) -> None:
            super().set_float(name, value)
            if name == "Gain":
                self.integers["OffsetX"] = 8

    with pytest.raises(SettingRefusedError, match="OffsetX: wanted 0, it reads back 8"):
        applied(Moving())


def test_a_gain_that_the_black_level_moves_is_refused() -> None:
    class Moving(PaperCamera):
        def set_float(self, name: str, value: float) -> None:
            super().set_float(name, value)
            if name == "BlackLevel":
                self.floats["Gain"] = 3.0

    camera = Moving()
    camera.floats["BlackLevel"] = 0.0
    with pytest.raises(SettingRefusedError, match="gain_db: wanted 0, it reads back 3"):
        applied(camera)


@pytest.mark.parametrize("missing", ["ExposureTime", "AcquisitionLineRate"])
def test_camera_without_a_needed_feature_is_refused_by_all_its_names(missing: str) -> None:
    camera = PaperCamera()
    del camera.floats[missing]
    with pytest.raises(SettingRefusedError) as caught:
        applied(camera)
    assert caught.value.code == "feature-unknown"
    assert f"{missing}, {missing}Abs" in str(caught.value)


def test_camera_without_gain_and_black_level_takes_0_and_nothing_else() -> None:
    camera = PaperCamera()
    del camera.floats["Gain"]
    assert applied(camera).gain_db == 0.0
    for change in ({"gain_db": 1.0}, {"black_level_dn": 5.0}):
        with pytest.raises(SettingRefusedError) as caught:
            applied(camera, CameraSettings(**{**vars(WANTED), **change}))
        assert caught.value.code == "feature-unknown"


def test_exposure_grows_only_after_the_period_and_shrinks_before_it() -> None:
    camera = PaperCamera(floats={"ExposureTime": 20.0, "AcquisitionLineRate": 25000.0})
    applied(camera)
    order = [name for name in camera.written if name in camera.floats]
    assert order == ["AcquisitionLineRate", "ExposureTime"]
    camera.written.clear()
    applied(camera, CameraSettings(20.0, 40.0, 64, 512))
    order = [name for name in camera.written if name in camera.floats]
    assert order == ["ExposureTime", "AcquisitionLineRate"]
