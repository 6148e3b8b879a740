"""Interpixel capacitance: a pixel's voltage also shows a little of its neighbours' charge.

Source: Moore, Ninkov and Forrest, Quantum efficiency overestimation and deterministic cross talk
resulting from interpixel capacitance, Opt. Eng. 45, 076402 (2006): charge that is collected is
coupled without noise of its own, so, unlike diffusion, it smooths shot noise.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.random import Generator

from calib.arrays import Lines
from calib.errors import InputError
from calib.forward.conditions import Conditions
from calib.forward.departure import Departure, Statistic, Variable
from calib.forward.effect import Stage
from calib.forward.parameter import parameter
from calib.forward.plan_needs import first_lack, flats, neighbours
from calib.recording.header import Block, CameraHeader


@dataclass(frozen=True)
class InterpixelCapacitance(Departure):
    """Exchange a share c of each pixel's signal with each of its neighbours.

    A pixel with two neighbours shows (1 - 2 c) of its own charge and c of each of theirs. The sum
    is kept: at the sensor's edge there is nothing to exchange with. Neighbours of independent
    pixels with variance v covary by 2 c (1 - 2 c) v in a line. Pixels couple where they lie
    side by side, whichever taps read them.

    Attributes:
        column_coupling: c between neighbouring columns.
        row_coupling: c between neighbouring rows of an area sensor; a line sensor has none.
    """

    name: ClassVar[str] = "interpixel_capacitance"
    stage: ClassVar[Stage] = Stage.VOLTS
    stochastic: ClassVar[bool] = False
    by_signal: ClassVar[bool] = True
    physics: ClassVar[str] = (
        "Neighbouring pixels share a fixed part of each other's signal after collection."
    )
    shows_in: ClassVar[Statistic] = "column_covariance"
    depends_on: ClassVar[tuple[Variable, ...]] = ("signal", "column")
    any_law: ClassVar[Variable | None] = "column"

    column_coupling: float = parameter(0.005, unit="1", low=0.0, high=0.2, neutral=0.0)
    row_coupling: float = parameter(0.0, unit="1", low=0.0, high=0.2, neutral=0.0)

    @classmethod
    def why_not_testable(cls, blocks: Sequence[Block], camera: CameraHeader) -> str | None:
        """Return what a recording lacks to show the coupling; None where it could."""
        return first_lack(neighbours(camera), flats(blocks, lines=2))

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:  # noqa: ARG002
        """Electrons in and out, (n_lines, *sample)."""
        coupled = np.array(signal, np.float64)
        couplings = (self.row_coupling, self.column_coupling)[-(signal.ndim - 1) :]
        for axis, coupling in enumerate(couplings, start=1):
            flow = np.moveaxis(coupling * np.diff(signal, axis=axis), axis, -1)
            along = np.moveaxis(coupled, axis, -1)
            along[..., :-1] += flow
            along[..., 1:] -= flow
        return coupled

    def check_camera(self, camera: CameraHeader) -> None:
        """Raise InputError where a line sensor's rows are to couple."""
        if camera.rows is None and self.row_coupling:
            raise InputError(
                f"effect interpixel_capacitance: row_coupling is {self.row_coupling}, but a line "
                "sensor has no rows; leave it out.",
                code="area-sensor",
            )
