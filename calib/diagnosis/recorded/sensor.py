"""How a sensor's pixels are grouped: rows, columns, taps, stretches of columns."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from calib.forward.taps import taps_of_camera
from calib.recording.header import CameraHeader

STRETCHES = 4
"""Parts of a line in which pooled statistics are kept apart."""


@dataclass(frozen=True)
class Sensor:
    """A line sensor is one row.

    Attributes:
        camera: As the recording says.
        noisy: Flat indices of pixels that pooled statistics leave out.
    """

    camera: CameraHeader
    noisy: tuple[int, ...] = ()

    @property
    def n_rows(self) -> int:
        """Rows of a sample."""
        return self.camera.rows or 1

    @property
    def n_columns(self) -> int:
        """Columns of a row."""
        return self.camera.columns

    @property
    def n_pixels(self) -> int:
        """Pixels of a sample."""
        return self.n_rows * self.n_columns

    @property
    def sample(self) -> tuple[int, ...]:
        """The shape of a sample in the forward model."""
        return (self.n_columns,) if self.camera.rows is None else (self.n_rows, self.n_columns)

    @cached_property
    def tap(self) -> NDArray[np.intp]:
        """The tap of each pixel, (n_rows, n_columns), numbered without gaps."""
        taps = np.broadcast_to(taps_of_camera(self.camera), self.sample)
        taps = taps.reshape(self.n_rows, self.n_columns)
        return np.unique(taps, return_inverse=True)[1].reshape(taps.shape).astype(np.intp)

    @cached_property
    def n_taps(self) -> int:
        """How many taps there are."""
        return int(self.tap.max()) + 1

    @cached_property
    def group(self) -> NDArray[np.intp]:
        """Tap and stretch of columns of each pixel, (n_rows, n_columns); n_groups is none."""
        stretch = np.arange(self.n_columns) * STRETCHES // self.n_columns
        group = np.asarray(self.tap * STRETCHES + stretch, np.intp)
        group.flat[list(self.noisy)] = self.n_groups
        return group

    @property
    def n_groups(self) -> int:
        """How many groups there are; some may be empty."""
        return self.n_taps * STRETCHES

    @cached_property
    def partner(self) -> NDArray[np.intp]:
        """Columns that are read at the same time by other taps, (n_partners, n_columns), or -1.

        Of halves and quarters, whether taps read in one direction or towards each other, and what
        they read a pixel earlier or later; the partners of odd and even columns are neighbours, and
        no partners here.
        """
        n, taps = self.n_columns, self.n_taps
        columns = np.arange(n)
        if taps < 2 or self.camera.tap_layout == "odd_even":
            return np.zeros((0, n), np.intp)
        width = n // 2 if self.camera.tap_layout in {"halves", "quadrants"} else n // taps
        read = [columns + width, n - 1 - columns]
        pairs = np.stack([each + late for late in (0, -1, 1) for each in read])
        return np.where((pairs > columns) & (pairs < n), pairs, -1).astype(np.intp)
