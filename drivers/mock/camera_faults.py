"""What can go wrong with the in-process camera, on command."""

from dataclasses import dataclass


@dataclass
class CameraFaults:
    """Faults that a test sets; the camera looks at them before each frame.

    Attributes:
        to_lose: So many of the next frames arrive damaged.
        stalled: The camera answers, but sends no frames any more.
        vanished: The camera is unplugged.
    """

    to_lose: int = 0
    stalled: bool = False
    vanished: bool = False

    def takes_next_frame(self) -> bool:
        """Whether the next frame is to be lost; counts down."""
        if not self.to_lose:
            return False
        self.to_lose -= 1
        return True
