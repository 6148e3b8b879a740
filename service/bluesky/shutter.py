"""The cap as something that moves: True is capped."""

from service.bench.bench import Bench
from service.bluesky.documents import DataKey, Reading, reading
from service.bluesky.work_status import WorkStatus


class BenchShutter:
    """Movable and readable; what it reads is where it was last seen to arrive.

    Attributes:
        name: Of the device in documents.
        parent: None, as for every device that stands alone.
    """

    parent = None

    def __init__(self, bench: Bench, name: str = "capped") -> None:
        self.name = name
        self._bench = bench
        self._is_capped: bool | None = None

    def set(self, value: bool) -> WorkStatus:
        """Cap the camera, or uncap it; done once it is there."""
        capped = bool(value)

        def move() -> None:
            self._is_capped = None
            self._bench.shutter.set_capped(capped)
            self._is_capped = capped

        return WorkStatus(move, self.name)

    def read(self) -> dict[str, Reading]:
        """Return whether the camera is capped; None where nobody has moved it yet."""
        return {self.name: reading(self._is_capped)}

    def describe(self) -> dict[str, DataKey]:
        """Describe what `read` gives."""
        return {self.name: {"source": f"{self._bench.id}:shutter", "dtype": "boolean", "shape": []}}
