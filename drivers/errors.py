"""How devices fail. Every error names the device; none leaves it lit."""

from calib.errors import DarkflatError


class DeviceError(DarkflatError):
    """A device did not do what it was told.

    Attributes:
        device: Which one, as the bench file calls it, with its address.
        last_exchange: The last bytes sent and received, for the report; empty where none.
    """

    def __init__(
        self, message: str, *, device: str, code: str = "device-failed", last_exchange: str = ""
    ) -> None:
        super().__init__(message, code=code)
        self.device = device
        self.last_exchange = last_exchange


class DeviceNotFoundError(DeviceError):
    """Nothing answers at the address."""


class DeviceBusyError(DeviceError):
    """Somebody else holds it."""


class DeviceLostError(DeviceError):
    """It was there and is gone: unplugged, control lost, server dead."""


class DeviceTimeoutError(DeviceError):
    """It is there but did not answer in time."""


class ProtocolError(DeviceError):
    """It answered what it never should."""


class SettingRefusedError(DeviceError):
    """It refused a setting, or reads back another value than was written."""
