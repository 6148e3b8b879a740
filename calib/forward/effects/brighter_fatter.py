"""Brighter-fatter: the charge that a pixel holds repels what comes next, into its neighbours.

Source: Antilogus et al., The brighter-fatter effect and pixel correlations in CCD sensors, JINST 9,
C03048 (2014): boundaries of pixels shift in proportion to the charges. Astier et al., The shape of
the photon transfer curve of CCD sensors, A&A 629, A36 (2019): to first order a flat of mean mu
electrons has covariances C_ij = mu (delta_i0 delta_j0 + a_ij mu), and charge is only moved, so the
sum of all a_ij is 0. Lage's flats of an e2v CCD for LSST give, per electron, 1.0e-7 along the row,
2.7e-7 along the column, 0.6e-7 across the corner. There, 40 % of the lost variance reappears beyond
the eight neighbours, which are all that is modelled here.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.random import Generator

from calib.arrays import Lines
from calib.forward.conditions import Conditions
from calib.forward.departure import Departure, Statistic, Variable
from calib.forward.effect import Stage
from calib.forward.parameter import parameter
from calib.forward.plan_needs import flats
from calib.recording.header import Block, CameraHeader

_Part = tuple[slice, ...]


@dataclass(frozen=True)
class BrighterFatter(Departure):
    """Move a (q1 + q2) / 2 x (q1 - q2) / 2 electrons from pixel 1 to its neighbour, pixel 2.

    The boundary's shift grows with q1 - q2 as the charge gathers, on average half of its last, and
    sweeps a flux that gave (q1 + q2) / 2. About a flat's mean mu that is a mu / 2 times the
    difference, whence C = a mu^2 between the two, and a variance of mu - mu^2 times the sum of a
    over all neighbours. In a line only those along it count: lines are not exposed side by side.

    Attributes:
        row_per_e: a between neighbours in one row, or line.
        column_per_e: Between neighbours in one column of a frame.
        corner_per_e: Between pixels of a frame that share a corner.
    """

    name: ClassVar[str] = "brighter_fatter"
    stage: ClassVar[Stage] = Stage.CHARGE
    stochastic: ClassVar[bool] = False
    by_signal: ClassVar[bool] = True
    physics: ClassVar[str] = (
        "A pixel's charge repels what comes next into its neighbours: their covariance is a mu^2, "
        "the variance mu - mu^2 times the sum of a."
    )
    shows_in: ClassVar[Statistic] = "column_covariance"
    depends_on: ClassVar[tuple[Variable, ...]] = ("signal", "column")

    row_per_e: float = parameter(1e-7, unit="1/e-", low=0.0, high=1e-4, neutral=0.0)
    column_per_e: float = parameter(2.7e-7, unit="1/e-", low=0.0, high=1e-4, neutral=0.0)
    corner_per_e: float = parameter(6e-8, unit="1/e-", low=0.0, high=1e-4, neutral=0.0)

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:  # noqa: ARG002
        """Electrons in and out, (n_lines, *sample)."""
        charge = np.array(signal, dtype=np.float64)
        squared = charge * charge
        for a_per_e, one, other in self._pairs(signal.ndim - 1):
            moved = (a_per_e / 4) * (squared[one] - squared[other])
            charge[one] -= moved
            charge[other] += moved
        return np.maximum(charge, 0.0)

    def _pairs(self, n_axes: int) -> Iterator[tuple[float, _Part, _Part]]:
        """Yield a, and where the pixels and their neighbours lie in (n_lines, *sample)."""
        every, first, last = slice(None), slice(None, -1), slice(1, None)
        along = (every,) * n_axes
        yield self.row_per_e, (*along, first), (*along, last)
        if n_axes > 1:
            yield self.column_per_e, (every, first, every), (every, last, every)
            yield self.corner_per_e, (every, first, first), (every, last, last)
            yield self.corner_per_e, (every, first, last), (every, last, first)

    @classmethod
    def why_not_testable(cls, blocks: Sequence[Block], camera: CameraHeader) -> str | None:  # noqa: ARG003
        """Return what `blocks` lack: lines of a flat that differ."""
        return flats(blocks, lines=2)
