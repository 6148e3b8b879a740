"""Spot: the source fills only a disc of the picture, as the image of a pinhole does.

Source: Yielding, Cain and Seal, Statistical photocalibration of photodetectors (2018), section 4: a
pinhole before an LED, imaged on some 200 pixels; its edge is blurred by the lens, here as by a
Gaussian.
"""

from dataclasses import dataclass
from functools import lru_cache
from math import inf
from typing import ClassVar

import numpy as np
from numpy.random import Generator
from scipy.special import erfc

from calib.arrays import Lines, Pixels, SampleShape
from calib.forward.conditions import Conditions
from calib.forward.effect import Effect, Stage
from calib.forward.parameter import parameter


@dataclass(frozen=True)
class Spot(Effect):
    """Scale the radiance by erfc((r - diameter / 2) / (sqrt(2) edge)) / 2, r from the centre.

    The profile's sum over the pixels is pi (diameter^2 / 4 + edge^2), as long as the edge is narrow
    and the whole disc lies on the sensor. A line cuts through the centre.

    Attributes:
        diameter_columns: Of the disc, to half of its height, in units of the column pitch.
        edge_std_columns: Standard deviation of the blur; 0 for a sharp edge.
        centre_column, centre_row: From 0; the middle where not given. A line has no row.
    """

    name: ClassVar[str] = "spot"
    stage: ClassVar[Stage] = Stage.SOURCE
    stochastic: ClassVar[bool] = False
    separable: ClassVar[bool] = True

    diameter_columns: float = parameter(200.0, unit="column", low=0.0, neutral=inf)
    edge_std_columns: float = parameter(1.5, unit="column", low=0.0, high=1e4)
    centre_column: float | None = parameter(None, unit="column")
    centre_row: float | None = parameter(None, unit="row")

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:  # noqa: ARG002
        """Radiance in, radiance out, (n_lines, *sample)."""
        return signal * self.profile(signal.shape[1:])

    def profile(self, sample: SampleShape) -> Pixels:
        """Return the share of the radiance that each pixel sees, (*sample,), read-only."""
        return _drawn(self, (sample,) if isinstance(sample, int) else sample)


@lru_cache(maxsize=8)
def _drawn(spot: Spot, shape: tuple[int, ...]) -> Pixels:
    """Return the profile."""
    centre = (spot.centre_row, spot.centre_column)[-len(shape) :]
    squared = np.zeros(())
    for n, at in zip(shape, centre, strict=True):
        along = np.arange(n) - ((n - 1) / 2 if at is None else at)
        squared = np.add.outer(squared, along**2)
    beyond = np.sqrt(squared) - spot.diameter_columns / 2
    if spot.edge_std_columns == 0:
        profile = np.asarray(beyond <= 0, np.float64)
    else:
        profile = np.asarray(erfc(beyond / (np.sqrt(2.0) * spot.edge_std_columns)) / 2)
    profile.flags.writeable = False
    return profile
