"""A shutter that is a person with a cap."""

from collections.abc import Callable

from drivers.errors import DeviceError
from drivers.ports import DeviceIdentity

Ask = Callable[[str], None]
"""Shows a request to a person and returns once it is done."""


class OperatorShutter:
    """Asks for the cap; assumes that it is off at first."""

    def __init__(self, ask: Ask | None) -> None:
        self._ask = ask
        self._capped = False

    @property
    def identity(self) -> DeviceIdentity:
        """A person."""
        return DeviceIdentity("", "operator", "")

    def set_capped(self, capped: bool) -> None:
        """Ask; DeviceError with code `no-operator` where nobody can be asked."""
        if capped == self._capped:
            return
        if self._ask is None:
            raise DeviceError(
                "this bench has no shutter and nobody to ask for the cap; name a shutter in the"
                ' bench file, use `driver = "lamps_off"`, or plan without darks',
                device="shutter",
                code="no-operator",
            )
        self._ask("Put the cap on the lens." if capped else "Take the cap off the lens.")
        self._capped = capped

    def close(self) -> None:
        """Nothing to release."""
