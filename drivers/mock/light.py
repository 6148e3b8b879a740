"""A sphere's lamps without a line: they warm up in the World, and fail when told to."""

import time
from contextlib import suppress
from threading import Event, Lock

from drivers.errors import DeviceError, SettingRefusedError
from drivers.mock.filament import relative_emission
from drivers.mock.mock_line import MockLine
from drivers.mock.world import World
from drivers.ports import Cancelled, DeviceIdentity, LampState, LightState, never
from drivers.serial.levels import whole_level

_DEVICE = "mock lamps"
_RAMP_STEPS = 4


class MockLight:
    """N lamps of a World, lamp 1 first. `off` may be called at any moment.

    Attributes:
        line: Its `fault` cuts the line; the lamps then stay as they are.
        broken: Lamps (from 1) that do not burn when told to.
        stuck: Lamps that do not go off when told to.
    """

    def __init__(
        self,
        world: World,
        *,
        n_lamps: int | None = None,
        tau_s: float = 0.05,
        ramp_s: float = 0.02,
        nominal_current_a: float = 4.0,
    ) -> None:
        """Drive the first `n_lamps` of `world` (all where None).

        Args:
            world: Where they burn.
            n_lamps: How many.
            tau_s: Time constant of their warming up and cooling down.
            ramp_s: How long the ramp of one lamp takes.
            nominal_current_a: At which a lamp's emission is 1.
        """
        self.line = MockLine(_DEVICE)
        self.broken: set[int] = set()
        self.stuck: set[int] = set()
        self._world = world
        self._n_lamps = len(world.state().lamps) if n_lamps is None else n_lamps
        self._tau_s = tau_s
        self._ramp_s = ramp_s
        self._nominal_a = nominal_current_a
        self._currents_a = [0.0] * self._n_lamps
        self._hours = [0.0] * self._n_lamps
        self._counted_at = time.monotonic()
        self._setting = Lock()
        self._off_orders = 0
        self._ordered_off = Event()

    @property
    def identity(self) -> DeviceIdentity:
        """A name that says that this is no hardware."""
        return DeviceIdentity("darkflat", "MockLight", "M0001", address="in-process")

    @property
    def max_level(self) -> float:
        """The number of lamps."""
        return float(self._n_lamps)

    def set_level(self, level: float, cancelled: Cancelled = never) -> LightState:
        """Burn the first `level` lamps. Raises as GenLamps does; what fails leaves nothing lit."""
        burning = whole_level(level, self._n_lamps, _DEVICE)
        with self._setting:
            order = self._off_orders
            self._ordered_off.clear()
            for lamp in range(1, self._n_lamps + 1):
                wanted_a = self._nominal_a if lamp <= burning else 0.0
                if not self._ramp(lamp, wanted_a, order, cancelled):
                    return self.state()
            state = self.state()
            for lamp, burns in enumerate(state.lamps, start=1):
                if burns.on != (lamp <= burning):
                    self.off()
                    raise SettingRefusedError(
                        f"{_DEVICE}: lamp {lamp} is off although it was switched on",
                        device=_DEVICE,
                        code="lamp-dark",
                    )
            return state

    def state(self) -> LightState:
        """Read every lamp back."""
        with self.line.exchange():
            self._count_hours()
            lamps = tuple(
                LampState(on=current_a > 0, current_a=current_a, hours=hours)
                for current_a, hours in zip(self._currents_a, self._hours, strict=True)
            )
        level = sum(lamp.current_a == self._nominal_a for lamp in lamps)
        return LightState(level=float(level), lamps=lamps)

    def order_off(self) -> None:
        """Switch everything off."""
        with suppress(DeviceError):  # it is done again, and read back
            self._put_out()

    def off(self) -> LightState:
        """Switch everything off and read it back; `lamps-not-off` names those that are still on."""
        self._put_out()
        state = self.state()
        lit = [str(number) for number, lamp in enumerate(state.lamps, start=1) if lamp.on]
        if lit:
            raise DeviceError(
                f"{_DEVICE}: not known to be off: lamp {', '.join(lit)}",
                device=_DEVICE,
                code="lamps-not-off",
            )
        return state

    def _put_out(self) -> None:
        self._off_orders += 1
        self._ordered_off.set()
        with self.line.exchange():
            for lamp in range(1, self._n_lamps + 1):
                self._drive(lamp, 0.0)

    def brown_out(self, lamp: int) -> None:
        """Let `lamp` (from 1) lose its mains now; it burns again when set to."""
        self._drive(lamp, 0.0)

    def close(self) -> None:
        """Release it; the lamps stay as they are. Safe to call twice."""
        self.line.close()

    def _ramp(self, lamp: int, wanted_a: float, order: int, cancelled: Cancelled) -> bool:
        from_a = self._currents_a[lamp - 1]
        if from_a == wanted_a:
            return True
        for step in range(1, _RAMP_STEPS + 1):
            if cancelled():
                return False
            with self.line.exchange():
                if self._off_orders != order:
                    raise DeviceError(
                        f"{_DEVICE}: switched off while the lamps were being set",
                        device=_DEVICE,
                        code="switched-off",
                    )
                self._drive(lamp, from_a + (wanted_a - from_a) * step / _RAMP_STEPS)
            self._ordered_off.wait(self._ramp_s / _RAMP_STEPS)
        return True

    def _drive(self, lamp: int, current_a: float) -> None:
        self._count_hours()
        if lamp in self.stuck and current_a < self._currents_a[lamp - 1]:
            return
        if lamp in self.broken:
            current_a = 0.0
        self._currents_a[lamp - 1] = current_a
        emission = relative_emission(current_a / self._nominal_a)
        self._world.drive(lamp - 1, emission, tau_s=self._tau_s)

    def _count_hours(self) -> None:
        now = time.monotonic()
        passed_h = (now - self._counted_at) / 3600.0
        self._hours = [
            hours + (passed_h if current_a > 0 else 0.0)
            for hours, current_a in zip(self._hours, self._currents_a, strict=True)
        ]
        self._counted_at = now
