"""What every shutter promises; subclass `ShutterContract` and give a `shutter` fixture."""

import pytest

from drivers.errors import DeviceError
from drivers.ports import Shutter


class ShutterContract:
    """Promises of `drivers.ports.Shutter`."""

    def test_says_who_it_is(self, shutter: Shutter) -> None:
        assert shutter.identity.vendor
        assert shutter.identity.model
        assert shutter.identity.address

    @pytest.mark.parametrize("moves", [(True,), (False,), (True, False), (True, True, False)])
    def test_moves_and_may_be_told_twice(self, shutter: Shutter, moves: tuple[bool, ...]) -> None:
        for capped in moves:
            shutter.set_capped(capped)

    def test_close_twice_is_safe_and_later_calls_fail(self, shutter: Shutter) -> None:
        shutter.close()
        shutter.close()
        with pytest.raises(DeviceError) as caught:
            shutter.set_capped(True)
        assert caught.value.code == "device-closed"
