"""An open bench: its devices, and the one way to leave it."""

from collections.abc import Callable
from contextlib import ExitStack
from types import TracebackType
from typing import Self

from drivers.errors import DeviceError
from drivers.mock.world import World
from drivers.ports import LightSource, LightState, LinescanCamera, Monitor, Shutter
from service.bench.shielded import shielded


class Bench:
    """Owned by this process until closed; a context manager. Leaving it is always dark.

    Attributes:
        id: Of the bench, from its file.
        camera: Takes the lines.
        light: The source.
        monitor: Watches the source; None on a bench without.
        shutter: Caps the camera for darks.
        caps_by_lamps_off: True where a dark means that the lamps are off.
        world: What the simulated devices share; None on real hardware.
    """

    def __init__(
        self,
        bench_id: str,
        *,
        camera: LinescanCamera,
        light: LightSource,
        shutter: Shutter,
        monitor: Monitor | None = None,
        caps_by_lamps_off: bool = False,
        world: World | None = None,
        resources: ExitStack | None = None,
        on_close: Callable[[], None] | None = None,
    ) -> None:
        self.id = bench_id
        self.camera = camera
        self.light = light
        self.monitor = monitor
        self.shutter = shutter
        self.caps_by_lamps_off = caps_by_lamps_off
        self.world = world
        self._resources = resources or ExitStack()
        self._on_close = on_close
        self._is_open = True

    def safe_off(self) -> LightState:
        """Switch every lamp off and read it back; no second Ctrl-C gets in between.

        Raises:
            DeviceError: With code `lamps-not-off`; says what has to be switched off by hand.
        """
        with shielded():
            try:
                state = self.light.off()
            except DeviceError as error:
                if error.code == "lamps-not-off":
                    raise
                raise _not_off(str(error), error.device, error.last_exchange) from error
            lit = [str(i + 1) for i, lamp in enumerate(state.lamps) if lamp.on]
            if lit or state.level > 0:
                reason = f"lamp {', '.join(lit)} reads back as on" if lit else "its level is not 0"
                raise _not_off(reason, self.light.identity.address)
            return state

    def close(self) -> None:
        """Switch the lamps off, read them back, release every device. Safe to call twice.

        Raises:
            DeviceError: The lamps could not be read back as off; all is released all the same.
        """
        if not self._is_open:
            return
        self._is_open = False
        with shielded():
            try:
                self.safe_off()
            finally:
                self._resources.close()
                if self._on_close is not None:
                    self._on_close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()


def _not_off(reason: str, device: str, last_exchange: str = "") -> DeviceError:
    return DeviceError(
        f"the lamps could not be read back as off ({reason}): switch them off by hand",
        device=device,
        code="lamps-not-off",
        last_exchange=last_exchange,
    )
