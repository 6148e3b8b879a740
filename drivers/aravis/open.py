"""Finds a camera and takes control of it, or says why not and what to do."""

from drivers.aravis.gi_aravis import aravis, connect, glib_error, known_devices
from drivers.aravis.gi_types import GiCamera
from drivers.aravis.interfaces import ipv4_interfaces, reach_hint
from drivers.errors import DeviceBusyError, DeviceError, DeviceNotFoundError

_USB_HINT = (
    "USB: this user may not open it; install Aravis' udev rule as "
    '/etc/udev/rules.d/aravis.rules (SUBSYSTEM=="usb", ATTRS{idVendor}=="<vendor>", '
    'MODE="0666"), then `udevadm control --reload` and plug it in again'
)


def open_camera(address: str, device: str) -> GiCamera:
    """Return the camera at `address`, in our control, with Aravis' own checks switched on.

    Args:
        address: An IP address, a host name, or `Vendor-Serial`.
        device: What errors call it.

    Raises:
        DeviceNotFoundError: Nothing answers; says which interfaces were tried and what was found.
        DeviceBusyError: Somebody else controls it.
        DeviceError: Code `usb-permission`, naming the udev rule.
    """
    module = aravis()
    try:
        camera = connect(address)
    except glib_error() as error:
        raise _explained(error, address, device) from error
    if camera.is_gv_device() and not camera.get_device().is_controller():
        raise DeviceBusyError(
            f"{device}: another program controls it; end that program, or wait until its "
            "heartbeat runs out (3 s after it died)",
            device=device,
            code="device-busy",
        )
    camera.set_range_check_policy(module.RangeCheckPolicy.ENABLE)
    camera.set_access_check_policy(module.AccessCheckPolicy.ENABLE)
    return camera


def _explained(error: Exception, address: str, device: str) -> DeviceError:
    said = getattr(error, "message", "") or str(error)
    if "LIBUSB_ERROR_ACCESS" in said or "Failed to claim USB" in said:
        return DeviceError(f"{device}: {said}; {_USB_HINT}", device=device, code="usb-permission")
    seen = known_devices()
    found = f"found instead: {'; '.join(seen)}" if seen else "no other camera was found"
    bare = any(f"-{address} at " in each for each in seen)
    hint = (
        "a bare serial number is not enough, write Vendor-Serial"
        if bare
        else reach_hint(address, ipv4_interfaces())
    )
    return DeviceNotFoundError(
        f"{device}: no GigE Vision or USB3 Vision camera answers; {hint}; {found}",
        device=device,
        code="device-not-found",
        last_exchange=said,
    )
