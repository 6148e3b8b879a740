"""Draws each frame of the simulated camera, from the registers as they are at that moment."""

import time
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from calib.arrays import RawLines
from calib.kernels.packed_pixels import pack_mono12p, pack_mono12packed
from drivers.aravis.simulated.fake_camera import FakeCamera
from drivers.aravis.simulated.line_clock import LineClock
from drivers.aravis.simulated.registers import Register
from drivers.mock.sensor import VirtualSensor
from drivers.pixel_formats import BY_PFNC
from drivers.ports import CameraSettings, PixelFormat


def put(dn: RawLines, pixel_format: PixelFormat, into: NDArray[np.uint8]) -> None:
    """Put a frame's codes into the bytes of a frame, as the format lays them out.

    Raises:
        ValueError: The frame is too small for them.
    """
    if pixel_format == "Mono12Packed":
        pack_mono12packed(dn.reshape(-1).astype(np.uint16, copy=False), into)
    elif pixel_format == "Mono12p":
        pack_mono12p(dn.reshape(-1).astype(np.uint16, copy=False), into)
    else:
        little_endian = dn.astype(dn.dtype.newbyteorder("<"), copy=False)
        on_wire = np.ascontiguousarray(little_endian).reshape(-1).view(np.uint8)
        into[: on_wire.size] = on_wire


class Picture:
    """The camera's fill callback. Nothing that it raises leaves it: Aravis' thread would die.

    A frame that cannot be drawn is not sent, nor any after it: a wrong picture is worse than none.
    """

    def __init__(self, camera: FakeCamera, sensor: VirtualSensor) -> None:
        self._camera = camera
        self._sensor = sensor
        self._clock = LineClock()
        self._began_s = time.monotonic()
        self._due: tuple[int, Callable[[], None]] | None = None
        self.failure: Exception | None = None

    def after(self, n_frames: int, act: Callable[[], None]) -> None:
        """Call `act` between the next `n_frames` frames and those that follow; forget earlier ones.

        Where `n_frames` is 0, at once.
        """
        self._due = None
        if n_frames == 0:
            act()
        else:
            self._due = (n_frames, act)

    def settings(self) -> CameraSettings:
        """Return what the client has written into the registers."""
        read = self._camera.read
        is_area = self._sensor.model.camera.rows is not None
        return CameraSettings(
            exposure_us=read(Register.EXPOSURE_10NS) / 100,
            line_period_us=read(Register.LINE_PERIOD_10NS) / 100,
            frame_lines=1 if is_area else read(Register.HEIGHT),
            n_columns=read(Register.WIDTH),
            first_column=read(Register.OFFSET_X),
            n_rows=read(Register.HEIGHT) if is_area else None,
            first_row=read(Register.OFFSET_Y) if is_area else 0,
            pixel_format=BY_PFNC[read(Register.PIXEL_FORMAT)].name,
            gain_db=read(Register.GAIN_CENTIBEL) / 100,
            black_level_dn=read(Register.BLACK_LEVEL_CENTIDN) / 100,
        )

    def fill(self, frame: NDArray[np.uint8]) -> None:
        """Draw one frame into `frame`; on failure let nothing leave the camera any more."""
        try:
            self._act_when_due()
            settings = self.settings()
            self.pace(settings)
            now_s = time.monotonic() - self._began_s
            started_s = self._clock.next_frame(now_s, settings.frame_lines, settings.line_period_us)
            put(self._sensor.expose(settings, started_s), settings.pixel_format, frame)
        except Exception as error:
            self.failure = error
            self._camera.lose_packets(1.0)

    def _act_when_due(self) -> None:
        """Called before each frame: Aravis sends one whole before it asks for the next."""
        if self._due is None:
            return
        n_frames, act = self._due
        self._due = (n_frames - 1, act) if n_frames else None
        if n_frames == 0:
            act()

    def pace(self, settings: CameraSettings) -> None:
        """Derive the frame period from the line rate: the fake camera knows no lines."""
        period_us = round(settings.frame_lines * settings.line_period_us)
        self._camera.write(Register.FRAME_PERIOD_US, max(period_us, 1))
