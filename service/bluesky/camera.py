"""The camera: staged at its settings, triggered for some frames, read as their mean line."""

import threading
from dataclasses import dataclass
from typing import Any

import numpy as np

from calib.arrays import Columns
from drivers.ports import CameraSettings, CapturedFrame, LinescanCamera
from service.bluesky.documents import DataKey, Reading, array, number, reading
from service.bluesky.work_status import WorkStatus


@dataclass(frozen=True)
class _Taken:
    """Frames: the mean of their lines, (n_columns,), DN, and what was lost on the way."""

    mean_dn: Columns
    lost: int
    at_s: float


class BenchCamera:
    """Stageable, triggerable, readable, configurable.

    Attributes:
        name: Of the device in documents.
        parent: None, as for every device that stands alone.
        settings: What is asked for when it is staged.
        frames: How many whole ones a trigger takes.
    """

    parent = None

    def __init__(
        self, camera: LinescanCamera, settings: CameraSettings, *, source: str, name: str = "camera"
    ) -> None:
        self.name = name
        self.settings = settings
        self.frames = 1
        self._camera = camera
        self._source = source
        self._used = settings
        self._stopped = threading.Event()
        self._taken: _Taken | None = None

    def stage(self) -> list[Any]:
        """Apply the settings; `read_configuration` tells what the camera made of them."""
        self._used = self._camera.configure(self.settings)
        return [self]

    def unstage(self) -> list[Any]:
        """Forget what was taken."""
        self._taken = None
        return [self]

    def trigger(self) -> WorkStatus:
        """Take frames; a lost one is taken again."""
        self._stopped.clear()

        def take() -> None:
            self._taken = self._take()

        return WorkStatus(take, self.name)

    def stop(self, success: bool = True) -> None:  # noqa: ARG002  (Bluesky's own)
        """Take no more frames."""
        self._stopped.set()

    def read(self) -> dict[str, Reading]:
        """Return mean line, mean and lost frames of the last trigger; taken now where none was."""
        taken = self._take() if self._taken is None else self._taken
        return {
            f"{self.name}_mean_dn": reading(float(taken.mean_dn.mean()), taken.at_s),
            f"{self.name}_mean_line_dn": reading(taken.mean_dn, taken.at_s),
            f"{self.name}_lost_frames": reading(taken.lost, taken.at_s),
        }

    def describe(self) -> dict[str, DataKey]:
        """Describe what `read` gives."""
        return {
            f"{self.name}_mean_dn": number(self._source, "DN"),
            f"{self.name}_mean_line_dn": array(self._source, "DN", np.empty(self._used.n_columns)),
            f"{self.name}_lost_frames": number(self._source, ""),
        }

    def read_configuration(self) -> dict[str, Reading]:
        """Return the settings that the camera really uses, read back."""
        return {
            f"{self.name}_exposure_us": reading(self._used.exposure_us),
            f"{self.name}_line_period_us": reading(self._used.line_period_us),
            f"{self.name}_gain_db": reading(self._used.gain_db),
        }

    def describe_configuration(self) -> dict[str, DataKey]:
        """Describe what `read_configuration` gives."""
        units = {"exposure_us": "us", "line_period_us": "us", "gain_db": "dB"}
        return {f"{self.name}_{key}": number(self._source, unit) for key, unit in units.items()}

    def _take(self) -> _Taken:
        frames = list(self._camera.frames(self.frames, self._stopped.is_set))
        whole = [each for each in frames if isinstance(each, CapturedFrame)]
        means = [frame.dn.mean(axis=0, dtype=np.float64) for frame in whole]
        at_s = whole[-1].host_timestamp_ns * 1e-9
        return _Taken(np.mean(means, axis=0), len(frames) - len(whole), at_s)
