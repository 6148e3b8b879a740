"""The simulated camera as a whole: protocol, registers, sensor, faults."""

import os
import signal
from collections.abc import Sequence
from functools import partial
from pathlib import Path

import numpy as np
from numpy.random import Generator

from calib.forward.model import Model
from drivers.aravis.simulated.fake_camera import FakeCamera
from drivers.aravis.simulated.picture import Picture, put
from drivers.aravis.simulated.registers import MODEL_NAME, VENDOR_NAME, Register
from drivers.errors import DeviceError
from drivers.mock.sensor import VirtualSensor, aligned
from drivers.mock.world import World
from drivers.pixel_formats import FORMATS, smallest_for

VENDOR = "darkflat"


class Server:
    """Answers as soon as it is made; the kernels are compiled by then."""

    def __init__(
        self,
        *,
        address: str,
        serial: str,
        description: Path,
        model: Model,
        world: World,
        rng: Generator,
    ) -> None:
        self._world = world
        self._lost_ratio = 0.0
        sensor = self._sensor = VirtualSensor(model, world, rng)
        self._camera = FakeCamera(address, serial, description)
        self._picture = Picture(self._camera, sensor)
        self._reset(model)
        self._warm_up(sensor)
        self._camera.fill_with(self._picture.fill)
        self.tick()

    def tick(self) -> None:
        """Keep up with the world: tell the temperature. Called a few times a second.

        Raises:
            DeviceError: Code `cannot-draw`: a frame could not be drawn; the camera is of no use.
        """
        failure = self._picture.failure
        if failure is not None:
            raise DeviceError(
                f"cannot draw a frame: {failure!r}", device="simulated camera", code="cannot-draw"
            ) from failure
        temperature_c = self._world.state().sensor_temperature_c
        self._camera.write_float(Register.TEMPERATURE_C, temperature_c)

    def obey(self, word: str, rest: Sequence[str]) -> bool:
        """Do what a line on the control channel says; False where it says nothing we know."""
        match word, rest:
            case "lose", [ratio, n_frames]:
                self._picture.after(int(n_frames), partial(self._lose, float(ratio)))
            case "stall", [n_frames]:  # it answers, but no packet of a frame leaves it
                self._picture.after(int(n_frames), partial(self._camera.lose_packets, 1.0))
            case "die", [n_frames]:
                self._picture.after(int(n_frames), _die)
            case "resume", []:
                self._picture.after(0, partial(self._camera.lose_packets, self._lost_ratio))
            case "afresh", []:
                self._sensor.draw_afresh()
            case _:
                return False
        return True

    def _lose(self, ratio: float) -> None:
        self._lost_ratio = ratio
        self._camera.lose_packets(ratio)

    def _reset(self, model: Model) -> None:
        """Write the values after power-on."""
        header = model.camera
        self._camera.write_text(VENDOR_NAME, VENDOR)
        self._camera.write_text(MODEL_NAME, header.model or "linescan")
        period_us = header.line_period_us or 1000.0
        values = {
            Register.SENSOR_WIDTH: header.columns,
            Register.WIDTH: header.columns,
            Register.HEIGHT: header.rows or 64,
            Register.OFFSET_X: 0,
            Register.OFFSET_Y: 0,
            Register.PIXEL_FORMAT: FORMATS[smallest_for(header.bit_depth)].pfnc,
            Register.LINE_PERIOD_10NS: round(period_us * 100),
            Register.EXPOSURE_10NS: round(period_us * 50),
            Register.GAIN_CENTIBEL: 0,
            Register.BLACK_LEVEL_CENTIDN: 0,
        }
        for register, value in values.items():
            self._camera.write(register, value)
        self._picture.pace(self._picture.settings())

    def _warm_up(self, sensor: VirtualSensor) -> None:
        """Compile every kernel now: control is not answered while a frame is drawn."""
        settings = self._picture.settings()
        dn = sensor.expose(settings, 0.0)
        for code in FORMATS.values():
            put(aligned(dn, code.bits, code.name), code.name, np.empty(2 * dn.size, np.uint8))


def _die() -> None:
    """As a camera does that is unplugged: without a last word."""
    os.kill(os.getpid(), signal.SIGKILL)
