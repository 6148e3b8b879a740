"""Aravis' errors in our words."""

from collections.abc import Iterator
from contextlib import contextmanager

from drivers.aravis.gi_aravis import aravis, glib_error
from drivers.errors import (
    DeviceBusyError,
    DeviceError,
    DeviceLostError,
    DeviceNotFoundError,
    DeviceTimeoutError,
    SettingRefusedError,
)


@contextmanager
def speaking(device: str, doing: str) -> Iterator[None]:
    """Raise what Aravis raises while `doing` something as one of `drivers.errors`."""
    try:
        yield
    except glib_error() as error:
        raise translated(error, device, doing) from error


def translated(error: Exception, device: str, doing: str) -> DeviceError:
    """Return the error of ours that says the same as a `GLib.Error`."""
    kind, code = _kinds().get(
        (getattr(error, "domain", ""), int(getattr(error, "code", -1))),
        (DeviceError, "device-failed"),
    )
    said = getattr(error, "message", "") or str(error)
    return kind(f"{device}: cannot {doing}: {said}", device=device, code=code, last_exchange=said)


def _kinds() -> dict[tuple[str, int], tuple[type[DeviceError], str]]:
    device, genicam = aravis().DeviceError, aravis().GcError
    of_device: dict[object, tuple[type[DeviceError], str]] = {
        device.NOT_FOUND: (DeviceNotFoundError, "device-not-found"),
        device.NOT_CONNECTED: (DeviceLostError, "control-lost"),
        device.NOT_CONTROLLER: (DeviceBusyError, "device-busy"),
        device.PROTOCOL_ERROR_ACCESS_DENIED: (DeviceBusyError, "device-busy"),
        device.TIMEOUT: (DeviceTimeoutError, "device-timeout"),
        device.FEATURE_NOT_FOUND: (SettingRefusedError, "feature-unknown"),
        device.PROTOCOL_ERROR_INVALID_PARAMETER: (SettingRefusedError, "setting-refused"),
        device.PROTOCOL_ERROR_WRITE_PROTECT: (SettingRefusedError, "feature-read-only"),
    }
    of_genicam: dict[object, tuple[type[DeviceError], str]] = {
        genicam.OUT_OF_RANGE: (SettingRefusedError, "setting-out-of-range"),
        genicam.READ_ONLY: (SettingRefusedError, "feature-read-only"),
        genicam.ENUM_ENTRY_NOT_FOUND: (SettingRefusedError, "setting-unknown"),
        genicam.NODE_NOT_FOUND: (SettingRefusedError, "feature-unknown"),
    }
    return {
        **{("arv-device-error-quark", int(code)): kind for code, kind in of_device.items()},  # type: ignore[call-overload]
        **{("arv-gc-error-quark", int(code)): kind for code, kind in of_genicam.items()},  # type: ignore[call-overload]
    }
