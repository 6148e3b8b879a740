"""What every camera promises; subclass `CameraContract` and give `camera` and `wanted`."""

import math
from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from drivers.errors import DeviceError, SettingRefusedError
from drivers.pixel_formats import FORMATS
from drivers.ports import CameraSettings, CapturedFrame, LinescanCamera, LostFrame


def whole(frames: Iterator[CapturedFrame | LostFrame]) -> list[CapturedFrame]:
    return [frame for frame in frames if isinstance(frame, CapturedFrame)]


class CameraContract:
    """Promises of `drivers.ports.LinescanCamera`.

    `camera` is open and dark or lit, as it likes; `wanted` are settings that it can take, with
    room for half as many lines and twice the line period.
    """

    def test_says_who_it_is(self, camera: LinescanCamera) -> None:
        assert camera.identity.vendor
        assert camera.identity.model
        assert camera.identity.serial
        assert camera.identity.address

    def test_configure_returns_settings_that_it_keeps(
        self, camera: LinescanCamera, wanted: CameraSettings
    ) -> None:
        used = camera.configure(replace(wanted, exposure_us=wanted.exposure_us * 0.98765))
        assert camera.configure(used) == used

    def test_configure_returns_what_was_wanted_but_for_rounding(
        self, camera: LinescanCamera, wanted: CameraSettings
    ) -> None:
        used = camera.configure(wanted)
        assert used.exposure_us == pytest.approx(wanted.exposure_us, rel=0.01)
        assert used.line_period_us == pytest.approx(wanted.line_period_us, rel=0.01)
        assert (used.frame_shape, used.first_column, used.first_row, used.pixel_format) == (
            wanted.frame_shape, wanted.first_column, wanted.first_row, wanted.pixel_format,
        )  # fmt: skip

    def test_exposure_and_line_period_change_in_either_order(
        self, camera: LinescanCamera, wanted: CameraSettings
    ) -> None:
        slow = replace(
            wanted,
            line_period_us=2 * wanted.line_period_us,
            exposure_us=1.9 * wanted.line_period_us,
        )
        for settings in (wanted, slow, wanted):
            used = camera.configure(settings)
            assert used.exposure_us == pytest.approx(settings.exposure_us, rel=0.01)
            assert used.line_period_us == pytest.approx(settings.line_period_us, rel=0.01)

    @pytest.mark.parametrize(
        ("setting", "value"),
        [
            ("exposure_us", -1.0),
            ("exposure_us", 1e12),
            ("exposure_us", math.nan),
            ("line_period_us", 0.0),
            ("line_period_us", 1e12),
            ("line_period_us", math.inf),
            ("n_columns", 0),
            ("n_columns", 10_000_000),
            ("first_column", 10_000_000),
            ("frame_lines", 0),
            ("n_rows", 0),
            ("n_rows", 10_000_000),
            ("first_row", 10_000_000),
            ("gain_db", 1e6),
            ("pixel_format", "RGB8"),
        ],
    )
    def test_refuses_what_it_cannot_do_and_says_what(
        self, camera: LinescanCamera, wanted: CameraSettings, setting: str, value: float | str
    ) -> None:
        with pytest.raises(SettingRefusedError) as caught:
            camera.configure(replace(wanted, **{setting: value}))
        assert caught.value.code.startswith(("setting-", "pixel-format-"))
        assert camera.configure(wanted).frame_lines == wanted.frame_lines

    def test_gives_as_many_whole_frames_as_asked(
        self, camera: LinescanCamera, wanted: CameraSettings
    ) -> None:
        used = camera.configure(wanted)
        frames = whole(camera.frames(5))
        assert len(frames) == 5
        code = FORMATS[used.pixel_format]
        for frame in frames:
            assert frame.dn.shape == used.frame_shape
            assert frame.dn.dtype == (np.uint8 if code.bits == 8 else np.uint16)
            assert int(frame.dn.max()) < 1 << code.bits
            assert frame.exposure_us == used.exposure_us
            assert frame.gain_db == used.gain_db

    def test_none_asked_none_given(self, camera: LinescanCamera, wanted: CameraSettings) -> None:
        camera.configure(wanted)
        assert list(camera.frames(0)) == []

    def test_frames_are_counted_and_dated_in_order(
        self, camera: LinescanCamera, wanted: CameraSettings
    ) -> None:
        camera.configure(wanted)
        frames = whole(camera.frames(4))
        assert len({frame.frame_id for frame in frames}) == 4
        stamps = [frame.device_timestamp_ns for frame in frames]
        assert stamps == sorted(set(stamps))
        stamps = [frame.host_timestamp_ns for frame in frames]
        assert stamps == sorted(stamps)

    def test_a_frame_stays_as_it_was_when_more_come(
        self, camera: LinescanCamera, wanted: CameraSettings
    ) -> None:
        camera.configure(wanted)
        kept, copies = [], []
        for frame in whole(camera.frames(25)):
            kept.append(frame.dn)
            copies.append(frame.dn.copy())
        assert all(np.array_equal(a, b) for a, b in zip(kept, copies, strict=True))
        assert not any(np.shares_memory(a, b) for a, b in pairwise(kept))

    def test_frames_follow_a_change_of_their_size(
        self, camera: LinescanCamera, wanted: CameraSettings
    ) -> None:
        height = "frame_lines" if wanted.n_rows is None else "n_rows"
        n = getattr(wanted, height)
        for wanted_height in (n, n // 2, n):
            camera.configure(replace(wanted, **{height: wanted_height}))
            assert all(f.dn.shape[0] == wanted_height for f in whole(camera.frames(2)))

    def test_cancelled_before_it_starts_gives_nothing(
        self, camera: LinescanCamera, wanted: CameraSettings
    ) -> None:
        camera.configure(wanted)
        assert list(camera.frames(3, lambda: True)) == []
        assert len(whole(camera.frames(1))) == 1

    def test_cancelled_under_way_ends_early(
        self, camera: LinescanCamera, wanted: CameraSettings
    ) -> None:
        camera.configure(wanted)
        seen: list[object] = []
        for frame in camera.frames(1000, lambda: len(seen) >= 3):
            seen.append(frame)  # noqa: PERF402  the list is asked for its length meanwhile
        assert 3 <= len(seen) < 1000

    def test_can_be_configured_after_an_acquisition_is_closed(
        self, camera: LinescanCamera, wanted: CameraSettings
    ) -> None:
        camera.configure(wanted)
        frames = camera.frames(1000)
        next(frames)
        frames.close()  # type: ignore[attr-defined]
        camera.configure(wanted)
        assert len(whole(camera.frames(1))) == 1

    def test_refuses_to_be_configured_while_acquiring(
        self, camera: LinescanCamera, wanted: CameraSettings
    ) -> None:
        camera.configure(wanted)
        frames = camera.frames(1000)
        next(frames)
        with pytest.raises(DeviceError) as caught:
            camera.configure(wanted)
        assert caught.value.code == "camera-acquiring"
        assert next(frames) is not None
        frames.close()  # type: ignore[attr-defined]

    def test_refuses_a_second_acquisition_beside_the_first(
        self, camera: LinescanCamera, wanted: CameraSettings
    ) -> None:
        camera.configure(wanted)
        frames = camera.frames(1000)
        next(frames)
        with pytest.raises(DeviceError) as caught:
            next(camera.frames(1))
        assert caught.value.code == "camera-acquiring"
        frames.close()  # type: ignore[attr-defined]

    def test_tells_its_temperature_or_none(self, camera: LinescanCamera) -> None:
        temperature_c = camera.temperature_c()
        assert temperature_c is None or -60.0 < temperature_c < 120.0

    def test_tells_all_its_features(self, camera: LinescanCamera, wanted: CameraSettings) -> None:
        camera.configure(wanted)
        features = camera.features()
        assert len(features) > 5
        assert all(isinstance(value, str) for value in features.values())
        assert wanted.pixel_format in features.values()

    def test_close_twice_is_as_good_as_once(
        self, camera: LinescanCamera, wanted: CameraSettings
    ) -> None:
        camera.close()
        camera.close()
        with pytest.raises(DeviceError) as caught:
            camera.configure(wanted)
        assert caught.value.code == "device-closed"

    def test_close_ends_an_acquisition(
        self, camera: LinescanCamera, wanted: CameraSettings
    ) -> None:
        camera.configure(wanted)
        frames = camera.frames(1000)
        next(frames)
        camera.close()
        with pytest.raises(DeviceError) as caught:
            for _ in frames:
                pass
        assert caught.value.code == "device-closed"
