"""Darks without a shutter: the lamps are off."""

import time

from drivers.ports import DeviceIdentity, LightSource


class LampsOffShutter:
    """Caps by switching the lamps off; whoever uncaps sets the level again."""

    def __init__(self, light: LightSource, *, afterglow_s: float) -> None:
        self._light = light
        self._afterglow_s = afterglow_s

    @property
    def identity(self) -> DeviceIdentity:
        """The light's own."""
        return self._light.identity

    def set_capped(self, capped: bool) -> None:
        """Return once the filaments are dark; nothing happens on uncapping."""
        if capped:
            self._light.off()
            time.sleep(self._afterglow_s)

    def close(self) -> None:
        """Nothing to release: the light is closed by the bench."""
