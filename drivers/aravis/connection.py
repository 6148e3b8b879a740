"""The control channel to one camera: taken, watched, given back, taken again."""

import gc
from threading import Event
from typing import cast

from drivers.aravis import feature_names as names
from drivers.aravis.features import Features
from drivers.aravis.gi_aravis import glib_error
from drivers.aravis.gi_errors import speaking
from drivers.aravis.gi_types import GiCamera
from drivers.aravis.interfaces import is_loopback
from drivers.aravis.open import open_camera
from drivers.aravis.unpack import ByteOrder
from drivers.errors import DeviceError, DeviceLostError, DeviceTimeoutError
from drivers.ports import DeviceIdentity

LOOPBACK_PACKET_SIZE = 16384
"""Loopback carries more than a network does: 645 MB/s instead of a fraction of it."""


class Connection:
    """An open camera. When control is lost it says so; a new connection is then needed."""

    def __init__(self, address: str, device: str) -> None:
        self.device = device
        self._lost = Event()
        self.camera: GiCamera = open_camera(address, device)
        lost = self._lost  # the handler runs in Aravis' thread: it sets a flag and does no more
        handler = self.camera.get_device().connect("control-lost", lambda *_: lost.set())
        self._handler = handler
        self.features = Features(self.camera, device)
        self.identity = self._read_identity(address)
        self.byte_order = self._read_byte_order()
        self.default_packet_size = LOOPBACK_PACKET_SIZE if is_loopback(address) else None
        self.temperature_name = self._find_temperature()

    def must_hold(self) -> None:
        """Raise DeviceLostError where control is lost."""
        if self._lost.is_set():
            raise self.lost_error("its heartbeat is no longer answered, or another took control")

    def lost_error(self, why: str, remedy: str = "check power and cable") -> DeviceLostError:
        """Mark the connection as lost; return the error to raise."""
        self._lost.set()
        return DeviceLostError(
            f"{self.device}: lost: {why}; {remedy}, then configure it again",
            device=self.device,
            code="control-lost",
        )

    @property
    def lost(self) -> bool:
        """Whether control is lost."""
        return self._lost.is_set()

    def answers(self) -> bool:
        """Ask the camera for one register; False after Aravis' own retries (2.5 s)."""
        try:
            self.camera.get_payload()
        except glib_error():
            return False
        return True

    def obeys(self) -> bool:
        """Stop its acquisition; False where it takes no order, though it may answer questions.

        Whoever took control reads the same in the control register as we do: only an order tells.
        """
        try:
            self.stop_acquisition()
        except DeviceError:
            return False
        return not self.lost

    def set_locked(self, locked: bool) -> None:
        """Tell the camera that a stream is set up, so that it refuses what would break it."""
        name = self.features.first_of(names.LOCK)
        if name is not None:
            self.features.write_number(name, float(locked))

    def stop_acquisition(self) -> None:
        """Stop an acquisition, ours or one that a dead client left; a lost camera has none."""
        if self.lost:
            return
        try:
            with speaking(self.device, "stop its acquisition"):
                self.camera.stop_acquisition()
            self.set_locked(False)
        except DeviceTimeoutError:  # after five tries: there is nobody any more
            self._lost.set()

    def close(self) -> None:
        """Give control back, so that the next owner need not wait for the heartbeat to run out."""
        device = self.camera.get_device()
        device.disconnect(self._handler)
        if self.camera.is_gv_device() and not self.lost:
            try:
                device.leave_control()
            except glib_error():
                self._lost.set()  # it is gone: nothing is left to give back
        del device, self.camera, self.features
        gc.collect()  # the sockets close with the last reference

    def _read_identity(self, address: str) -> DeviceIdentity:
        firmware = self.features.first_of(("DeviceVersion", "DeviceFirmwareVersion"))
        return DeviceIdentity(
            vendor=self.camera.get_vendor_name(),
            model=self.camera.get_model_name(),
            serial=self.camera.get_device_serial_number(),
            firmware=self.features.text(firmware) if firmware else "",
            address=address,
        )

    def _read_byte_order(self) -> ByteOrder:
        name = self.features.first_of(names.BYTE_ORDER)
        told = self.features.text(name).lower() if name else "little"
        return cast("ByteOrder", told) if told in ("little", "big") else "little"

    def _find_temperature(self) -> str | None:
        """Choose the place nearest to the sensor; return the feature that tells its temperature."""
        places = self.features.entries("DeviceTemperatureSelector")
        nearest = next((p for p in ("Sensor", "SensorBoard", "Mainboard") if p in places), None)
        if nearest is not None:
            self.features.write_entry("DeviceTemperatureSelector", nearest)
        return self.features.first_of(names.TEMPERATURE_C)
