"""How many frames may be lost before a link no longer counts as sound."""

from drivers.errors import DeviceError

ALWAYS_ALLOWED = 8
ALLOWED_SHARE = 0.5


class LossLimit:
    """Count lost frames of one acquisition; a link that loses too many is an error, not a wait."""

    def __init__(self, n_frames: int, device: str) -> None:
        self.allowed = max(ALWAYS_ALLOWED, round(ALLOWED_SHARE * n_frames))
        self.lost = 0
        self._n_frames = n_frames
        self._device = device

    def count_lost(self, hint: str = "") -> None:
        """Count one lost frame.

        Raises:
            DeviceError: Code `frames-lost`, when more are lost than a sound link loses.
        """
        self.lost += 1
        if self.lost > self.allowed:
            raise DeviceError(
                f"{self._device}: {self.lost} frames lost while taking {self._n_frames}"
                f"{'; ' if hint else ''}{hint}",
                device=self._device,
                code="frames-lost",
            )
