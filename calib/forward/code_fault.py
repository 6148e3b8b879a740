"""Faults of whole codes: each sample has one or not, by chance of its own.

What such a fault does to codes is a map, so that what it does to a pixel's histogram, mean and
noise follows from its codes without the fault, and nothing needs to be drawn. Taps have converters
of their own: a fault may be one tap's alone.
"""

from abc import abstractmethod
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.arrays import Lines, SampleShape
from calib.errors import InputError
from calib.forward.departure import Departure
from calib.forward.parameter import parameter
from calib.forward.taps import LAYOUTS, check_layout, tap_of_pixel
from calib.recording.header import CameraHeader


@dataclass(frozen=True, kw_only=True)
class CodeFault(Departure):
    """A departure that maps the codes which the converter gives, after all else.

    Attributes:
        only_tap: The tap that has it, from 0; left out, all have.
        tap_layout: Which pixels a tap reads; that of the camera.
    """

    only_tap: int | None = parameter(None, unit="tap", low=0, high=3)
    tap_layout: str = parameter("single", unit="", choices=LAYOUTS)

    @property
    @abstractmethod
    def chance(self) -> float:
        """With which a sample has the fault, 0 to 1."""

    @abstractmethod
    def faulty(self, codes: Lines) -> Lines:
        """Return what whole codes become that have it, of any shape."""

    def slope(self, codes: Lines) -> Lines:
        """Return by how much codes that have it move with what they would be, on average."""
        return np.ones_like(codes)

    def acts_on(self, tap: int) -> bool:
        """Return whether the codes of a tap, from 0, may have it."""
        return self.only_tap is None or self.only_tap == tap

    def acting(self, sample: SampleShape) -> NDArray[np.bool_]:
        """Return which pixels' codes may have it, (*sample)."""
        if self.only_tap is None:
            return np.ones(sample, bool)
        return np.asarray(tap_of_pixel(self.tap_layout, sample) == self.only_tap)

    def check_camera(self, camera: CameraHeader) -> None:
        """Raise InputError unless the camera has the tap."""
        if self.only_tap is None:
            return
        check_layout(self.tap_layout, camera, f"effect {self.name}")
        if self.only_tap >= camera.taps:
            raise InputError(
                f"effect {self.name}: only_tap is {self.only_tap}, but the camera's taps are 0 to "
                f"{camera.taps - 1}; give one of those.",
                code="no-such-tap",
            )
