"""The bench file: which devices a bench has, and where."""

import tomllib
from pathlib import Path
from typing import Any

from pydantic import Field, ValidationError, model_validator

from calib.errors import InputError, reason_of
from service.bench.camera_settings import AravisCameraPart, CameraPart
from service.bench.light_settings import GenLightPart, LightPart, MightexLightPart
from service.bench.monitor_settings import KeithleyMonitorPart, MonitorPart, NoMonitorPart
from service.bench.part import BenchPart
from service.bench.shutter_settings import OperatorShutterPart, RelayShutterPart, ShutterPart
from service.plan.one_sentence import one_sentence


class Simulation(BenchPart):
    """A bench that is not there: what its camera sees, and what lights it."""

    model: str = "agcam-nir"
    """A preset's name, or a model file relative to the bench file; see `Model.named`."""
    lamps: int = Field(default=6, ge=1, le=31)
    seed: int | None = Field(default=None, ge=0)
    """Of the noise of a run from its beginning; None takes one from the system, as does a resumed
    run, which must not repeat the noise of what it goes on with."""
    camera_serial: str | None = None
    """What the simulated camera tells; None: the model's."""
    interface: str = "127.0.0.1"
    """At which the simulated GigE Vision camera answers."""
    camera_wait_s: float = Field(default=30.0, ge=0)
    """How long to wait for the address while another simulated camera has it."""
    warm_up_s: float = Field(default=0.3, ge=0)
    """Time constant with which emulated lamps warm up."""
    baudrate: int = Field(default=9600, gt=0)
    """Bits per second of the emulated lines; a pseudo-terminal takes any from the devices."""
    world: Path | None = None
    """The file that the simulated devices share; None: a temporary one."""


class BenchSettings(BenchPart):
    """Everything that `open_bench` has to know."""

    id: str = Field(default="bench", pattern=r"^[A-Za-z0-9][A-Za-z0-9._-]*$")
    """Two benches on one machine have different ones."""
    camera: CameraPart
    light: LightPart
    monitor: MonitorPart = NoMonitorPart()
    shutter: ShutterPart = OperatorShutterPart()
    simulation: Simulation | None = None

    @classmethod
    def load(cls, path: Path) -> "BenchSettings":
        """Read a bench file; raises InputError with code `bench-invalid`."""
        try:
            content = tomllib.loads(path.read_text(encoding="utf-8"))
        except (OSError, UnicodeDecodeError) as error:
            msg = f"{path} cannot be read ({reason_of(error)}); name a bench file in UTF-8"
            raise InputError(msg, code="bench-unreadable") from error
        except (ValueError, RecursionError) as error:
            msg = f"{path} is not valid TOML ({error}); correct it"
            raise InputError(msg, code="bench-invalid") from error
        return cls.parse(content, where=str(path)).beside(path.parent)

    @classmethod
    def parse(cls, content: Any, *, where: str = "the bench file") -> "BenchSettings":
        """Check a bench file that is already a mapping."""
        try:
            return cls.model_validate(content)
        except ValidationError as error:
            sentence = one_sentence(error, cls)
            raise InputError(f"{where}: {sentence}", code="bench-invalid") from error

    def beside(self, folder: Path) -> "BenchSettings":
        """Return the same bench, its relative paths taken from `folder`."""
        changed: dict[str, Any] = {}
        if isinstance(self.light, GenLightPart) and self.light.hours_path is not None:
            hours_path = folder / self.light.hours_path
            changed["light"] = self.light.model_copy(update={"hours_path": hours_path})
        if self.simulation is not None:
            changed["simulation"] = _beside(self.simulation, folder)
        return self.model_copy(update=changed)

    @property
    def needs_simulated_camera(self) -> bool:
        """True where the camera is a simulated GigE Vision device."""
        return isinstance(self.camera, AravisCameraPart) and self.camera.address is None

    @property
    def needs_emulators(self) -> bool:
        """True where a controller is an emulator on a pseudo-terminal."""
        return any(part.port is None for _, part in self._on_ports())

    @property
    def max_level(self) -> float | None:
        """How many lamps the light has; None where only the light itself tells, as an LED does."""
        if isinstance(self.light, GenLightPart) and self.light.addresses:
            return len(self.light.addresses)
        if isinstance(self.light, MightexLightPart) or self.simulation is None:
            return None
        return self.simulation.lamps

    @model_validator(mode="after")
    def _is_somewhere(self) -> "BenchSettings":
        if self.simulation is not None:
            return self
        parts = (self.camera, self.light, self.monitor, self.shutter)
        if any(part.driver == "mock" for part in parts):
            msg = "mock devices need a [simulation]; add one, with the model that they show"
            raise ValueError(msg)
        if self.needs_simulated_camera:
            msg = "camera.address is missing; name the camera, or add a [simulation]"
            raise ValueError(msg)
        for name, part in self._on_ports():
            if part.port is None:
                msg = f"{name}.port is missing; name the serial port, or add a [simulation]"
                raise ValueError(msg)
        if isinstance(self.light, GenLightPart) and not self.light.addresses:
            msg = "light.addresses is missing; list the supplies' addresses, lamp 1 first"
            raise ValueError(msg)
        return self

    def _on_ports(
        self,
    ) -> list[tuple[str, GenLightPart | MightexLightPart | KeithleyMonitorPart | RelayShutterPart]]:
        parts = (("light", self.light), ("monitor", self.monitor), ("shutter", self.shutter))
        kinds = (GenLightPart, MightexLightPart, KeithleyMonitorPart, RelayShutterPart)
        return [(name, part) for name, part in parts if isinstance(part, kinds)]


def _beside(simulation: Simulation, folder: Path) -> Simulation:
    from calib.forward.model_file import is_preset_name  # noqa: PLC0415  (brings every effect)

    changed: dict[str, Any] = {}
    if not is_preset_name(simulation.model):
        changed["model"] = str(folder / simulation.model)
    if simulation.world is not None:
        changed["world"] = folder / simulation.world
    return simulation.model_copy(update=changed)
