"""Aravis' fake GigE Vision camera, and its registers and pixels through ctypes."""

import ctypes
import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivers.aravis.gi_aravis import aravis
from drivers.aravis.native import library, pointer_of, writable_bytes
from drivers.aravis.simulated.registers import Register
from drivers.errors import DeviceNotFoundError

Fill = Callable[[NDArray[np.uint8]], None]
"""Fills the bytes of the frame that is about to be sent, in Aravis' thread."""

_FILL = ctypes.CFUNCTYPE(
    None, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_uint32, ctypes.c_uint32, ctypes.c_uint32
)


class FakeCamera:
    """A GigE Vision device that answers at `address`; hold that address first.

    `set_fill_pattern` through PyGObject crashes, its closure being freed after the call; ctypes
    registers the callback instead.
    """

    def __init__(self, address: str, serial: str, description: Path) -> None:
        module = aravis()
        self._gige: Any = module.GvFakeCamera.new_full(address, serial, str(description))
        if not self._gige.is_running():
            raise DeviceNotFoundError(
                f"{address}: no network interface of this machine has that address",
                device=address,
                code="no-such-interface",
            )
        camera = self._gige.get_fake_camera()
        self._camera = camera  # the pointer below is valid as long as this lives
        self._pointer = pointer_of(camera)
        self._functions = library()
        self._declare()
        self._callback: object = None

    def read(self, register: Register) -> int:
        """Return a register."""
        value = ctypes.c_uint32()
        self._functions.arv_fake_camera_read_register(
            self._pointer, int(register), ctypes.byref(value)
        )
        return value.value

    def write(self, register: Register, value: int) -> None:
        """Set a register."""
        self._functions.arv_fake_camera_write_register(self._pointer, int(register), value)

    def write_float(self, register: Register, value: float) -> None:
        """Set a register that holds a float."""
        self.write(register, struct.unpack(">I", struct.pack(">f", value))[0])

    def write_text(self, at: tuple[int, int], text: str) -> None:
        """Set a text, cut to its length."""
        address, length = at
        data = text.encode()[: length - 1].ljust(length, b"\0")
        self._functions.arv_fake_camera_write_memory(self._pointer, address, length, data)

    def fill_with(self, fill: Fill) -> None:
        """Let `fill` draw every frame from now on; it must not raise."""

        def called(buffer: int, _data: int, _exposure: int, _gain: int, _format: int) -> None:
            fill(writable_bytes(buffer, self._frame_bytes()))

        self._callback = _FILL(called)  # kept: Aravis calls it as long as the camera lives
        self._functions.arv_fake_camera_set_fill_pattern(self._pointer, self._callback, None)

    def lose_packets(self, ratio: float) -> None:
        """Lose this share of the packets at random, leaders and trailers too."""
        self._gige.set_property("gvsp-lost-ratio", ratio)

    def _frame_bytes(self) -> int:
        """Return the size of a frame. Aravis has made sure that its buffer holds as much."""
        bits_per_pixel = (self.read(Register.PIXEL_FORMAT) >> 16) & 0xFF
        return self.read(Register.WIDTH) * self.read(Register.HEIGHT) * bits_per_pixel // 8

    def _declare(self) -> None:
        pointer, u32 = ctypes.c_void_p, ctypes.c_uint32
        functions = self._functions
        functions.arv_fake_camera_read_register.argtypes = [pointer, u32, ctypes.POINTER(u32)]
        functions.arv_fake_camera_write_register.argtypes = [pointer, u32, u32]
        functions.arv_fake_camera_write_memory.argtypes = [pointer, u32, u32, ctypes.c_char_p]
        functions.arv_fake_camera_set_fill_pattern.argtypes = [pointer, _FILL, pointer]
        functions.arv_fake_camera_set_fill_pattern.restype = None
