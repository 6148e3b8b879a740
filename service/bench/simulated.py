"""Starts what a simulated bench consists of: the world, the emulators, the camera's process."""

import tempfile
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from drivers.errors import DeviceError
from drivers.mock.world import World
from service.bench.settings import BenchSettings, Simulation

if TYPE_CHECKING:  # not what a bench of hardware should have to import
    from calib.forward.model import Model
    from drivers.aravis.simulated_process import SimulatedCameraProcess
    from drivers.mock.emulators.process import EmulatorProcess


@dataclass(frozen=True)
class Simulated:
    """What stands in for hardware.

    Attributes:
        simulation: As the bench file describes it.
        world: What burns in it, and whether the lens is capped.
        emulators: The process with the emulated controllers, which injects their faults; None
            where there is none.
        camera: The process with the simulated GigE Vision camera, which injects its faults; None
            where there is none.
        reseeding: For each device that draws noise, what makes it draw noise of its own.
    """

    simulation: Simulation
    world: World
    emulators: "EmulatorProcess | None" = None
    camera: "SimulatedCameraProcess | None" = None
    reseeding: list[Callable[[], None]] = field(default_factory=list)

    def draw_afresh(self) -> None:
        """Let every device draw noise that no seed repeats, whatever the bench file says.

        For an attempt that goes on with a recording: with the noise of the first attempt once
        more, its frames would not be independent of those that are there.
        """
        for reseed in self.reseeding:
            reseed()

    @property
    def camera_address(self) -> str:
        """Where the simulated GigE Vision camera answers."""
        return "" if self.camera is None else self.camera.address

    def model(self) -> "Model":
        """Return the forward model that its camera shows."""
        from calib.forward.model import Model  # noqa: PLC0415

        model = Model.named(self.simulation.model)
        serial = self.simulation.camera_serial or model.camera.serial
        return replace(model, camera=model.camera.model_copy(update={"serial": serial}))

    def port(self, name: str) -> str:
        """Return the port of the emulated controller `name`."""
        port = None if self.emulators is None else self.emulators.ports[name]
        if port is None:
            raise DeviceError(
                f"the simulated bench has no {name}; name its port in the bench file",
                device=name,
                code="no-such-emulator",
            )
        return port


def start_simulated(settings: BenchSettings, resources: ExitStack) -> Simulated | None:
    """Start what `settings` ask for; `resources` stop it. None on a bench of hardware alone."""
    simulation = settings.simulation
    if simulation is None:
        return None
    has_led = settings.light.driver == "mightex"
    n_lamps = 0 if has_led else simulation.lamps
    world = _world(simulation, n_lamps + has_led, resources)
    emulators = camera = None
    if settings.needs_emulators:
        emulators = _start_emulators(simulation, world, n_lamps, resources, led=has_led)
    if settings.needs_simulated_camera:
        camera = _start_camera(simulation, world, resources)
    simulated = Simulated(simulation, world, emulators, camera)
    if camera is not None:
        simulated.reseeding.append(camera.draw_afresh)
    if emulators is not None:
        simulated.reseeding.append(partial(emulators.inject, "monitor afresh"))
    return simulated


def _world(simulation: Simulation, n_lamps: int, resources: ExitStack) -> World:
    """Make it afresh: what burnt in a world that was left behind does not burn any more."""
    path = simulation.world
    if path is None:
        folder = resources.enter_context(tempfile.TemporaryDirectory(prefix="darkflat-world-"))
        path = Path(folder) / "world"
    world = World.create(path, n_lamps)
    resources.callback(world.close)
    _let_drift(world, simulation)
    return world


def _let_drift(world: World, simulation: Simulation) -> None:
    """Let the monitor see how the lamps of the camera's model drift; the camera does anyway."""
    from calib.forward.effects.lamp_drift import LampDrift  # noqa: PLC0415
    from calib.forward.model import Model  # noqa: PLC0415

    drift = Model.named(simulation.model).effect("lamp_drift")
    if isinstance(drift, LampDrift):
        world.drift(drift.amplitude, drift.time_constant_s)


def _start_emulators(
    simulation: Simulation, world: World, n_lamps: int, resources: ExitStack, *, led: bool
) -> "EmulatorProcess":
    from drivers.mock.emulators.process import EmulatorProcess  # noqa: PLC0415

    options = ["--tau-s", str(simulation.warm_up_s), "--baudrate", str(simulation.baudrate)]
    if simulation.seed is not None:
        options += ["--seed", str(simulation.seed)]
    process = EmulatorProcess(world.path, lamps=n_lamps, led=led, options=tuple(options))
    resources.callback(process.close)
    return process


def _start_camera(
    simulation: Simulation, world: World, resources: ExitStack
) -> "SimulatedCameraProcess":
    from drivers.aravis.simulated_process import SimulatedCameraProcess  # noqa: PLC0415

    process = SimulatedCameraProcess(
        simulation.model,
        world.path,
        serial=simulation.camera_serial,
        interface=simulation.interface,
        seed=simulation.seed,
        wait_s=simulation.camera_wait_s,
    )
    return resources.enter_context(process)
