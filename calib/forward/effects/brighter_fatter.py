"""Brighter-fatter: the charge that a pixel holds repels what comes next, into its neighbours.

Source: Antilogus et al., The brighter-fatter effect and pixel correlations in CCD sensors, JINST 9,
C03048 (2014): boundaries of pixels shift in proportion to the charges. Astier et al., The shape of
the photon transfer curve of CCD sensors, A&A 629, A36 (2019), Equation 20: a flat of mean mu
electrons has covariances C = mu (delta + a mu + 2/3 a*a mu^2 + 1/3 a*a*a mu^3 + ...), * a
convolution over the lags, and charge is only moved, so the sum of all a_ij is 0. Of each spatial
frequency that is mu (1 - exp(-2 y)) / (2 y), where y mu is what the first order takes. Lage's
flats of an e2v CCD for LSST give, per electron, 1.0e-7 along the row,
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

STAGES = (0.10645, 0.236641, 0.393169, 0.584895, 0.830585, 1.0)
"""Shares of the move that the last charge would make, each of charge moved by the one before.

Half of y is moved of each frequency: 1 - y/2 (1 - 0.8306 y/2 (1 - ...)) is the square root of
(1 - exp(-2 y)) / (2 y), which is what charge that repels while it gathers leaves, to 1e-4 for y
from 0 to 4: the minimax polynomial of sixth degree that begins with 1 - y/2. The series itself is
of no use there, its radius is pi: of its terms those up to y^3 miss 2 % at y = 1, 33 % at y = 2.
"""


@dataclass(frozen=True)
class BrighterFatter(Departure):
    """Move a (q1 + q2) / 2 x (q1 - q2) / 2 electrons from pixel 1 to its neighbour, pixel 2.

    The boundary's shift grows with q1 - q2 as the charge gathers, on average half of its last, and
    sweeps a flux that gave (q1 + q2) / 2. About a flat's mean mu that is a mu / 2 times the
    difference, whence C = a mu^2 between the two, and a variance of mu - mu^2 times the sum of a
    over all neighbours. Where charge sends away what comes to its own pixel instead, profiles lose
    a / 2 of the difference of squares for the same covariances: how the two go together is left
    open to the diagnosis. Charge that has been moved repels from where it is, which holds
    covariances of all orders where the sum of a mu over all neighbours is below 2. In a line only
    neighbours along it count: lines are not exposed side by side.

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
    any_law: ClassVar[Variable | None] = "column"
    open_profiles: ClassVar[bool] = True

    row_per_e: float = parameter(1e-7, unit="1/e-", low=0.0, high=1e-2, neutral=0.0)
    column_per_e: float = parameter(2.7e-7, unit="1/e-", low=0.0, high=1e-2, neutral=0.0)
    corner_per_e: float = parameter(6e-8, unit="1/e-", low=0.0, high=1e-2, neutral=0.0)

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:  # noqa: ARG002
        """Electrons in and out, (n_lines, *sample)."""
        charge = np.asarray(signal, dtype=np.float64)
        # Nothing is promised of a so large that more is moved than there is, but that it ends.
        most = 2.0 * float(charge.max(initial=0.0))
        seen = charge
        for share in STAGES:
            seen = np.clip(charge + share * self._gained(seen), 0.0, most)
        return seen

    def _gained(self, charge: Lines) -> Lines:
        """Return what each pixel gains, e-, where `charge` is what repels and what is swept."""
        gained, squared = np.zeros_like(charge), charge * charge
        for a_per_e, one, other in self._pairs(charge.ndim - 1):
            moved = (a_per_e / 4) * (squared[one] - squared[other])
            gained[one] -= moved
            gained[other] += moved
        return gained

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
