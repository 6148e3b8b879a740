"""What every light source promises; subclass `LightContract` and give a `light` fixture."""

import math
import threading
import time

import pytest

from drivers.errors import DeviceError, SettingRefusedError
from drivers.ports import LightSource


class LightContract:
    """Promises of `drivers.ports.LightSource`.

    `part_level` is a level that the source has between 0 and its highest.
    """

    part_level: float

    def test_says_who_it_is(self, light: LightSource) -> None:
        assert light.identity.vendor
        assert light.identity.model
        assert light.identity.address

    def test_has_levels(self, light: LightSource) -> None:
        assert 0 < self.part_level < light.max_level

    def test_set_level_returns_what_it_reads_back(self, light: LightSource) -> None:
        returned = light.set_level(self.part_level)
        assert returned.level == pytest.approx(self.part_level)
        state = light.state()
        assert state.level == returned.level
        assert [lamp.on for lamp in state.lamps] == [lamp.on for lamp in returned.lamps]

    def test_burning_lamps_carry_current_and_the_others_none(self, light: LightSource) -> None:
        state = light.set_level(self.part_level)
        assert any(lamp.on for lamp in state.lamps)
        assert all((lamp.current_a > 0) == lamp.on for lamp in state.lamps)

    def test_level_goes_up_and_down(self, light: LightSource) -> None:
        for level in (light.max_level, self.part_level, 0.0, self.part_level):
            assert light.set_level(level).level == pytest.approx(level)

    def test_level_0_is_dark(self, light: LightSource) -> None:
        light.set_level(self.part_level)
        state = light.set_level(0.0)
        assert state.level == 0.0
        assert not any(lamp.on for lamp in state.lamps)

    @pytest.mark.parametrize("level", [-1.0, 1e6, math.nan, math.inf], ids=str)
    def test_refuses_levels_that_it_does_not_have_and_stays(
        self, light: LightSource, level: float
    ) -> None:
        light.set_level(self.part_level)
        with pytest.raises(SettingRefusedError) as caught:
            light.set_level(level)
        assert caught.value.code == "level-out-of-range"
        assert light.state().level == pytest.approx(self.part_level)

    def test_off_reads_back_dark(self, light: LightSource) -> None:
        light.set_level(light.max_level)
        state = light.off()
        assert state.level == 0.0
        assert not any(lamp.on for lamp in state.lamps)
        assert light.state().level == 0.0

    def test_ordered_off_it_goes_dark_and_burns_again_when_set(self, light: LightSource) -> None:
        light.set_level(light.max_level)
        light.order_off()
        give_up_s = time.monotonic() + 10.0
        while light.state().level > 0:
            assert time.monotonic() < give_up_s
        assert light.set_level(self.part_level).level == pytest.approx(self.part_level)

    def test_off_twice_is_as_good_as_once(self, light: LightSource) -> None:
        light.set_level(self.part_level)
        light.off()
        assert light.off().level == 0.0

    def test_burns_again_after_off(self, light: LightSource) -> None:
        light.set_level(self.part_level)
        light.off()
        assert light.set_level(self.part_level).level == pytest.approx(self.part_level)

    def test_cancelled_at_once_changes_nothing(self, light: LightSource) -> None:
        assert light.set_level(light.max_level, cancelled=lambda: True).level == 0.0

    def test_off_wins_over_a_thread_that_sets_the_level(self, light: LightSource) -> None:
        under_way = threading.Event()
        ended: list[DeviceError | None] = []

        def announce() -> bool:
            under_way.set()
            return False

        def ramp() -> None:
            try:
                light.set_level(light.max_level, cancelled=announce)
            except DeviceError as error:
                ended.append(error)
            else:
                ended.append(None)

        thread = threading.Thread(target=ramp)
        thread.start()
        assert under_way.wait(30)
        assert light.off().level == 0.0
        thread.join(30)
        # It may have been done just before; where not, it says why it ended.
        assert ended[0] is None or ended[0].code == "switched-off"
        assert light.state().level == 0.0

    def test_close_twice_is_safe_and_later_calls_fail(self, light: LightSource) -> None:
        light.close()
        light.close()
        with pytest.raises(DeviceError) as caught:
            light.state()
        assert caught.value.code == "device-closed"
