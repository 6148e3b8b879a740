"""Amplifier glow: the output amplifier shines on the pixels near it.

Source: Janesick, Scientific Charge-Coupled Devices, SPIE Press (2001), on luminescence of the
output amplifier: hot carriers emit near infrared light, which silicon guides and absorbs along its
way. It shows in a dark as light that decays from a corner. An amplifier that is on only during
readout, as that of NICMOS, adds the same at every exposure; one that is on all the time, as in a
line camera, adds in proportion to exposure, and that is modelled here.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.random import Generator

from calib.arrays import Lines, Pixels, SampleShape
from calib.forward.conditions import Conditions
from calib.forward.departure import Departure, Statistic, Variable
from calib.forward.effect import Stage
from calib.forward.parameter import parameter
from calib.forward.plan_needs import dark_growth
from calib.recording.header import Block, CameraHeader


@dataclass(frozen=True)
class AmplifierGlow(Departure):
    """Add rate exp(-distance / decay) x exposure time to the expected electrons.

    The distance counts pixels from an end of the line, of a frame from a corner.

    Attributes:
        electrons_per_us: The rate next to the amplifier.
        decay_columns: The distance over which the glow falls to 1/e, in units of the column pitch.
        end: At which end of the line the amplifier sits.
        corner: Of a frame, whether at its first or last row; a line has none.
    """

    name: ClassVar[str] = "amplifier_glow"
    stage: ClassVar[Stage] = Stage.CHARGE
    stochastic: ClassVar[bool] = False
    separable: ClassVar[bool] = True
    physics: ClassVar[str] = (
        "The output amplifier shines on the pixels near it: + g exp(-distance / decay) t."
    )
    shows_in: ClassVar[Statistic] = "mean"
    depends_on: ClassVar[tuple[Variable, ...]] = ("column", "exposure")

    electrons_per_us: float = parameter(0.05, unit="e-/us", low=0.0, high=1e6, neutral=0.0)
    decay_columns: float = parameter(100.0, unit="column", low=0.1, high=1e6)
    end: str = parameter("left", unit="", choices=("left", "right"))
    corner: str = parameter("top", unit="", choices=("top", "bottom"))

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:  # noqa: ARG002
        """Expected electrons in and out, (n_lines, *sample)."""
        return signal + self.rates(signal.shape[1:]) * at.exposure_us

    def rates(self, sample: SampleShape) -> Pixels:
        """Return the glow in each pixel, e-/us, (*sample,)."""
        shape = (sample,) if isinstance(sample, int) else sample
        distance = np.arange(shape[-1], dtype=np.float64)
        if self.end == "right":
            distance = distance[::-1]
        if len(shape) > 1:
            rows = np.arange(shape[0], dtype=np.float64)
            rows = rows[::-1] if self.corner == "bottom" else rows
            distance = np.hypot(rows[:, np.newaxis], distance)
        return np.asarray(self.electrons_per_us * np.exp(-distance / self.decay_columns))

    @classmethod
    def why_not_testable(cls, blocks: Sequence[Block], camera: CameraHeader) -> str | None:  # noqa: ARG003
        """Return what `blocks` lack: a dark signal that can grow."""
        return dark_growth(blocks)
