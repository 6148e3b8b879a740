"""A light whose command failed is left dark."""

from collections.abc import Callable

from drivers.errors import DeviceError


def off_after(error: DeviceError, off: Callable[[], object]) -> None:
    """Leave nothing lit behind `error`; note on it what could not be read back as off."""
    try:
        off()
    except DeviceError as second:
        error.add_note(str(second))
