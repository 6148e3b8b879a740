"""The only place that imports `gi`: Aravis 0.8 through GObject introspection."""

import warnings
from functools import cache
from typing import Any

from drivers.aravis.gi_types import GiBuffer, GiCamera
from drivers.errors import DeviceError


@cache
def aravis() -> Any:
    """Return the Aravis module.

    Raises:
        DeviceError: Code `aravis-missing`, when it is not installed; says how to mend that.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # PyGObject's own deprecations are not ours to mend
            import gi  # noqa: PLC0415  optional, and slow to import

            # 0.9 changes create_stream and set_fill_pattern.
            gi.require_version("Aravis", "0.8")
            from gi.repository import Aravis  # noqa: PLC0415
    except (ImportError, ValueError) as error:
        raise DeviceError(
            "Aravis 0.8 with its GObject introspection data is not installed "
            f"({error}); as root: apt-get install gir1.2-aravis-0.8 libgirepository1.0-dev gcc "
            "pkg-config libcairo2-dev; then: pip install 'darkflat[aravis]'",
            device="Aravis",
            code="aravis-missing",
        ) from error
    return Aravis


@cache
def glib_error() -> type[Exception]:
    """Return `GLib.Error`, which every call to a device may raise."""
    aravis()
    from gi.repository import GLib  # noqa: PLC0415

    found: type[Exception] = GLib.Error
    return found


def connect(address: str) -> GiCamera:
    """Return the camera at `address`; raises GLib.Error when nothing answers there."""
    camera: GiCamera = aravis().Camera.new(address)
    return camera


def new_buffer(n_bytes: int) -> GiBuffer:
    """Return a buffer of `n_bytes`, which Aravis allocates."""
    buffer: GiBuffer = aravis().Buffer.new_allocate(n_bytes)
    return buffer


def known_devices() -> tuple[str, ...]:
    """Look on every interface (about a second); return `id at address by protocol` of each."""
    module = aravis()
    module.update_device_list()
    return tuple(
        f"{module.get_device_id(i)} at {module.get_device_address(i)}"
        f" by {module.get_device_protocol(i)}"
        for i in range(module.get_n_devices())
    )
