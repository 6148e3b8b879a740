"""An open bench: its devices, and the one way to leave it."""

from collections.abc import Callable
from contextlib import ExitStack
from types import TracebackType

from calib.closing import Closing
from drivers.mock.world import World
from drivers.ports import LightSource, LightState, LinescanCamera, Monitor, Shutter
from service.bench.all_off import all_off
from service.bench.endings import Endings
from service.bench.shielded import shielded
from service.bench.simulated import Simulated
from service.bench.target import Target


class Bench(Closing):
    """Owned by this process until closed. Leaving it is always dark.

    Attributes:
        id: Of the bench, from its file.
        camera: Takes the lines.
        light: The source.
        monitor: Watches the source; None on a bench without.
        shutter: Caps the camera for darks.
        target: Puts a scene before the lens; None where nobody can.
        caps_by_lamps_off: True where a dark means that the lamps are off.
        sensor_columns: How many columns the camera has, where the bench file's model says so.
        sensor_rows: How many rows an area camera has, likewise.
        is_area: Whether the camera exposes whole frames; None until somebody has asked it.
        camera_band: The spectral band of the camera, where the bench file's model says so.
        simulated: What stands in for hardware, and injects its faults; None on real hardware.
    """

    def __init__(
        self,
        bench_id: str,
        *,
        camera: LinescanCamera,
        light: LightSource,
        shutter: Shutter,
        monitor: Monitor | None = None,
        target: Target | None = None,
        caps_by_lamps_off: bool = False,
        sensor_columns: int | None = None,
        sensor_rows: int | None = None,
        camera_band: str = "",
        simulated: Simulated | None = None,
    ) -> None:
        self.id = bench_id
        self.camera = camera
        self.light = light
        self.monitor = monitor
        self.shutter = shutter
        self.target = target
        self.caps_by_lamps_off = caps_by_lamps_off
        self.sensor_columns = sensor_columns
        self.sensor_rows = sensor_rows
        self.is_area: bool | None = None
        self.camera_band = camera_band
        self.simulated = simulated
        self._resources = ExitStack()
        self._afterwards = ExitStack()
        self._is_open = True
        self._endings: Endings | None = None

    @property
    def world(self) -> World | None:
        """What the simulated devices share; None on real hardware."""
        return None if self.simulated is None else self.simulated.world

    @property
    def is_ending(self) -> bool:
        """True once a signal asked this process to end."""
        return self._endings is not None and self._endings.is_ending

    def end_with(self, endings: Endings) -> None:
        """Stop work on this bench, and in the end the process, when a signal asks for it."""
        self._endings = endings

    def keep(self, resources: ExitStack) -> None:
        """Release `resources` on closing, after the lamps are off."""
        self._resources.push(resources)

    def on_close(self, callback: Callable[[], None]) -> None:
        """Call `callback` at the end of closing, when the process's signals are its own again."""
        self._afterwards.callback(callback)

    def safe_off(self) -> LightState:
        """Switch every lamp off and read it back; no second Ctrl-C gets in between.

        Raises:
            DeviceError: With code `lamps-not-off`; says what has to be switched off by hand.
        """
        with shielded():
            return all_off(self.light)

    def close(self) -> None:
        """Switch the lamps off, read them back, release every device. Safe to call twice.

        Raises:
            DeviceError: The lamps could not be read back as off; all is released all the same.
        """
        if not self._is_open:
            return
        self._is_open = False
        with self._afterwards, shielded(), self._resources:
            self.safe_off()

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Close; where a signal came and what it raised got lost on the way, raise that."""
        super().__exit__(kind, error, trace)
        if kind is None and self._endings is not None:
            self._endings.end()
