"""One block as it is taken: what every mechanism may look at."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tests.concealed.generator.plan import BlockPlan
from tests.concealed.generator.sensor import Sensor

Memory = dict[str, Any]
"""What a mechanism keeps from block to block, under its name; it belongs to one recording."""
Happened = dict[str, list[Any]]
"""What chance made of each block, by the name of the mechanism that made it."""
_HAPPENED = "happened"


def note(memory: Memory, name: str, what: Any) -> None:
    """Keep what chance made of a block: a filter that knows the truth knows that, too."""
    memory.setdefault(_HAPPENED, {}).setdefault(name, []).append(what)


def noted(memory: Memory) -> Happened:
    """Return what was kept of all blocks."""
    found: Happened = memory.get(_HAPPENED, {})
    return found


@dataclass(frozen=True)
class Scan:
    """A block, its sensor and its clock.

    Attributes:
        first_sample: Samples that were taken before this block: the camera's counter.
        top_radiance: Of the plan's brightest block.
        top_exposure_us: Of the plan's longest exposure.
        mean_temperature_c: Over the plan.
    """

    sensor: Sensor
    block: BlockPlan
    line_period_us: float
    duration_s: float
    first_sample: int
    top_radiance: float
    top_exposure_us: float
    mean_temperature_c: float

    @property
    def n_samples(self) -> int:
        """Lines or frames."""
        return self.block.n_samples

    @property
    def shape(self) -> tuple[int, int, int]:
        """Samples, rows, columns."""
        return (self.n_samples, *self.sensor.shape)

    @property
    def lit(self) -> bool:
        """Whether the cap is off."""
        return self.block.kind != "dark"

    @property
    def times_s(self) -> NDArray[np.float64]:
        """Start of each sample, (n_samples, 1, 1)."""
        period_s = self.line_period_us * 1e-6
        return column(self.block.started_s + np.arange(self.n_samples) * period_s)

    @property
    def share(self) -> NDArray[np.float64]:
        """The same as a share of the recording's duration."""
        return np.asarray(self.times_s / self.duration_s)

    @property
    def counter(self) -> NDArray[np.intp]:
        """The camera's counter of samples, (n_samples, 1, 1)."""
        return np.asarray(self.first_sample + column(np.arange(self.n_samples)))

    @property
    def warmth_k(self) -> float:
        """Temperature above the plan's mean."""
        return self.block.temperature_c - self.mean_temperature_c

    @property
    def top_e(self) -> float:
        """Electrons of a bright pixel in the brightest block."""
        most = self.top_radiance * self.top_exposure_us
        return most * self.sensor.electrons_per_radiance_us


def column(values: NDArray[Any]) -> NDArray[Any]:
    """Return one value per sample as (n_samples, 1, 1)."""
    return values[:, np.newaxis, np.newaxis]
