"""Tap crosstalk: an output tap sees a little of what another tap reads at the same time.

Source: Giavalisco, Cross-talk in the ACS WFC detectors, STScI Instrument Science Report ACS
2004-12: amplifiers show each other's mirror images, mostly negative. Here in proportion to the
signal that is read at that moment, or a pixel before where a shared multiplexer has not settled.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import ClassVar

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from calib.arrays import Lines
from calib.forward.conditions import Conditions
from calib.forward.departure import Departure, Statistic, Variable
from calib.forward.effect import Stage
from calib.forward.parameter import parameter
from calib.forward.plan_needs import first_lack, flats, taps
from calib.forward.registers import READOUTS, check_readout, read_before
from calib.forward.taps import LAYOUTS, check_layout, tap_of_column
from calib.recording.header import Block, CameraHeader


@dataclass(frozen=True)
class TapCrosstalk(Departure):
    """Add a fraction x of the signal that the tap's partner reads at the same time.

    Taps are partners that read next to each other (0 and 1, 2 and 3), column for column; where the
    two ends of the sensor are read outwards (`mirrored`), the partner of a column is its mirror
    image. Where pixels come late, it is what the partner has read just before. Uniform flats show
    nothing in their means but a gain of 1 + x; partners covary by 2 x v where each has the variance
    v, and by x v with either neighbour of a partner that was read before.

    Attributes:
        fraction: x.
        tap_layout: Which pixels a tap reads; that of the camera.
        mirrored: True where halves or quarters are read from the outer ends inwards.
        pixels_before: 0 for what the partner reads at the same time, 1 for the pixel before that.
        readout: Where the outputs are, which tells which pixel that is; that of the camera.
    """

    name: ClassVar[str] = "tap_crosstalk"
    stage: ClassVar[Stage] = Stage.VOLTS
    stochastic: ClassVar[bool] = False
    by_signal: ClassVar[bool] = True
    physics: ClassVar[str] = "Each tap sees a fraction of what its partner reads at the same time."
    shows_in: ClassVar[Statistic] = "column_covariance"
    depends_on: ClassVar[tuple[Variable, ...]] = ("tap", "signal")
    any_law: ClassVar[Variable | None] = "tap"

    fraction: float = parameter(0.002, unit="1", low=-0.5, high=0.5, neutral=0.0)
    tap_layout: str = parameter("odd_even", unit="", choices=LAYOUTS)
    mirrored: bool = parameter(False, unit="1")
    pixels_before: int = parameter(0, unit="1", low=0, high=1)
    readout: str = parameter("left", unit="", choices=READOUTS)

    @classmethod
    def why_not_testable(cls, blocks: Sequence[Block], camera: CameraHeader) -> str | None:
        """Return what a recording lacks to show crosstalk; None where it could."""
        return first_lack(taps(camera), flats(blocks, lines=2))

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:  # noqa: ARG002
        """DN above the offset in and out, (n_lines, *sample)."""
        column, partner = partners(self.tap_layout, self.mirrored, signal.shape[-1])
        if self.pixels_before:
            earlier = read_before(self.readout, signal.shape[-1], self.tap_layout)[partner]
            column, partner = column[earlier >= 0], earlier[earlier >= 0]
        mixed = np.array(signal, np.float64)
        mixed[..., column] += self.fraction * signal[..., partner]
        return mixed

    def check_camera(self, camera: CameraHeader) -> None:
        """Raise InputError unless `tap_layout`, and `readout` where it counts, are the camera's."""
        check_layout(self.tap_layout, camera, "effect tap_crosstalk")
        if self.pixels_before:
            check_readout(self.readout, camera, "effect tap_crosstalk")


@lru_cache(maxsize=8)
def partners(
    layout: str, mirrored: bool, n_columns: int
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return the columns that have a partner, and that partner, each (n,), read-only.

    A column too many in one of two taps has none.

    >>> partners("halves", True, 5)[1].tolist(), partners("odd_even", False, 5)[1].tolist()
    ([4, 3, 1, 0], [1, 0, 3, 2])
    """
    columns = np.arange(n_columns, dtype=np.intp)
    tap = tap_of_column("halves" if layout == "quadrants" else layout, n_columns)
    if layout == "single":
        found = columns[:0], columns[:0]
    elif mirrored and layout != "odd_even":
        other = columns[::-1]
        found = columns[other != columns], other[other != columns]
    else:
        sides = [(columns[tap == one], columns[tap == one + 1]) for one in range(0, tap.max(), 2)]
        cut = [(a[: len(b)], b[: len(a)]) for a, b in sides]
        pairs = [p for a, b in cut for p in zip((*a, *b), (*b, *a), strict=True)]
        column, partner = np.array(sorted(pairs), np.intp).reshape(-1, 2).T
        found = column, partner
    return found
