"""Charge-transfer inefficiency: each transfer leaves a share of the charge behind, which trails.

Source: Janesick, Scientific Charge-Coupled Devices (2001), chapter 5; Short et al., An analytical
model of radiation-induced charge transfer inefficiency for CCD detectors, MNRAS 430, 3078 (2013),
for loss as a power of the charge; Brodersen, Buss and Tasch, Experimental characterization of
transfer efficiency in charge-coupled devices, IEEE Trans. Electron Devices 22, 40 (1975), for which
powers there are: loss that is fixed (0), proportional (1), and, over barriers and where charge
meets the surface, more than proportional; Massey et al., An improved model of charge transfer
inefficiency, MNRAS 439, 887 (2014), for exponential trails. `calib.forward.partition` says why
independent electrons of uniform light show no covariance where the share is constant, and Snyder et
al., Characterization and correction of serial deferred charge in LSST camera ITL CCDs, J. Astron.
Telesc. Instrum. Syst. 7, 048002 (2021), that traps of real sensors do make neighbours correlate.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import exp
from typing import ClassVar

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from calib.arrays import Columns, Lines
from calib.forward.conditions import Conditions
from calib.forward.departure import Departure, Statistic, Variable
from calib.forward.effect import Stage
from calib.forward.parameter import parameter
from calib.forward.partition import part_of
from calib.forward.plan_needs import first_lack, flats, neighbours
from calib.forward.registers import READOUTS, check_readout, registers
from calib.forward.taps import LAYOUTS, check_layout
from calib.recording.header import Block, CameraHeader


@dataclass(frozen=True)
class Cti(Departure):
    """Defer a share 1 - (1 - e)^k of a pixel's charge q, k transfers from the output.

    e = per_transfer (q / reference_e)^(exponent - 1), held at 1 where it would be more. What is
    deferred appears 1, 2, 3 ... pixels farther from the output, fewer each by the factor
    exp(-1 / trail_columns); what trails out of the register's far end is not read. The loss goes
    by the charge as collected: a pixel's own refill on the way is left out, an error of the
    relative order k e. A row's register is empty when the next row enters it.

    Attributes:
        per_transfer: Share of the reference charge that one transfer leaves behind.
        reference_e: Charge for which that holds.
        exponent: Deferred charge grows as this power of the charge; below 1, small charges lose
            relatively more, above 1, large ones.
        trail_columns: Length of the trail in the register's own columns, to 1/e; 0 where all
            appears in the next of them.
        partition_noise: 1 where each electron is deferred by itself, 0 where exactly the share is,
            as where full traps decide.
        readout: Where the outputs are; that of the camera.
        tap_layout: Which columns share a register: that of the camera, or `single` where one
            register serves all taps.
    """

    name: ClassVar[str] = "cti"
    stage: ClassVar[Stage] = Stage.TRANSFER
    stochastic: ClassVar[bool] = True
    by_signal: ClassVar[bool] = True
    physics: ClassVar[str] = (
        "Each transfer to the output leaves a share of the charge behind, which trails."
    )
    shows_in: ClassVar[Statistic] = "column_covariance"
    depends_on: ClassVar[tuple[Variable, ...]] = ("column", "signal")

    per_transfer: float = parameter(1e-5, unit="1", low=0.0, high=0.01, neutral=0.0)
    reference_e: float = parameter(10_000.0, unit="e-", low=1.0, high=1e7)
    exponent: float = parameter(0.8, unit="1", low=0.0, high=2.0)
    trail_columns: float = parameter(0.5, unit="column", low=0.0, high=1e3)
    partition_noise: float = parameter(1.0, unit="1", low=0.0, high=1.0)
    readout: str = parameter("left", unit="", choices=READOUTS)
    tap_layout: str = parameter("single", unit="", choices=LAYOUTS)

    @classmethod
    def why_not_testable(cls, blocks: Sequence[Block], camera: CameraHeader) -> str | None:
        """Return what a recording lacks to show deferred charge; None where it could."""
        return first_lack(neighbours(camera), flats(blocks, lines=2))

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:  # noqa: ARG002
        """Electrons in and out, (n_lines, *sample)."""
        deferred = part_of(signal, self.deferred_share(signal), self.partition_noise, rng)
        read = np.array(signal - deferred)
        for register in registers(self.readout, signal.shape[-1], self.tap_layout):
            self._trail(read[..., register], deferred[..., register], rng)
        return read

    def deferred_share(self, charge: Lines) -> NDArray[np.float64]:
        """Return the share of each pixel's charge, electrons, that comes late, of its shape."""
        transfers = transfers_of_column(self.readout, charge.shape[-1], self.tap_layout)
        relative = np.maximum(charge, 1.0) / self.reference_e
        each = np.minimum(self.per_transfer * relative ** (self.exponent - 1.0), 1.0 - 1e-12)
        return np.asarray(-np.expm1(transfers * np.log1p(-each)))

    def _trail(self, read: Lines, deferred: Lines, rng: Generator) -> None:
        """Add to `read` what is deferred, both (..., n) in the order in which they are read."""
        if self.trail_columns == 0.0:
            read[..., 1:] += deferred[..., :-1]
            return
        released_share = 1.0 - exp(-1.0 / self.trail_columns)
        if self.partition_noise == 0.0:
            from scipy.signal import lfilter  # noqa: PLC0415  (1 s to import, and lamps may burn)

            # The same recursion without chance: a linear filter along the register.
            read += lfilter([0.0, released_share], [1.0, released_share - 1.0], deferred, axis=-1)
            return
        held = deferred[..., 0]
        for column in range(1, read.shape[-1]):
            released = part_of(held, released_share, self.partition_noise, rng)
            read[..., column] += released
            held = held - released + deferred[..., column]

    def check_camera(self, camera: CameraHeader) -> None:
        """Raise InputError unless `readout`, and taps that have registers, are the camera's."""
        check_readout(self.readout, camera, "effect cti")
        if self.tap_layout != "single":
            check_layout(self.tap_layout, camera, "effect cti")


def transfers_of_column(readout: str, n_columns: int, tap_layout: str = "single") -> Columns:
    """Return how many transfers take each column's charge to its output, (n_columns,).

    >>> transfers_of_column("both", 5)
    array([1., 2., 3., 2., 1.])
    >>> transfers_of_column("left", 6, "odd_even")
    array([1., 1., 2., 2., 3., 3.])
    """
    transfers = np.empty(n_columns)
    for register in registers(readout, n_columns, tap_layout):
        of_register = transfers[register]
        of_register[:] = np.arange(1, of_register.size + 1)
    return transfers
