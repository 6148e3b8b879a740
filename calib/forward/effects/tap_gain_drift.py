"""Tap gain drift: the taps' gains part as the camera warms up.

Source: Janesick, Photon Transfer (2007), on gain drift of the signal chain with temperature; each
tap has an amplifier of its own. First order, as `calib.forward.drift` has it.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

from numpy.random import Generator

from calib.arrays import Lines, by_line
from calib.forward.conditions import Conditions
from calib.forward.departure import Departure, Statistic, Variable
from calib.forward.drift import settled
from calib.forward.effect import Stage
from calib.forward.parameter import parameter
from calib.forward.plan_needs import first_lack, several_flats, taps
from calib.forward.taps import LAYOUTS, by_tap, check_taps
from calib.recording.header import Block, CameraHeader


@dataclass(frozen=True)
class TapGainDrift(Departure):
    """Scale each tap's signal by 1 + amplitude (1 - exp(-time / time_constant)).

    Attributes:
        amplitude: Relative change of each tap's gain, reached long after the recording's start;
            empty for none.
        time_constant_s: How fast it is reached.
        tap_layout: Which pixels a tap reads; that of the camera.
    """

    name: ClassVar[str] = "tap_gain_drift"
    stage: ClassVar[Stage] = Stage.VOLTS
    stochastic: ClassVar[bool] = False
    physics: ClassVar[str] = (
        "One tap's gain drifts against the other: K -> K (1 + a (1 - exp(-t/T)))."
    )
    shows_in: ClassVar[Statistic] = "mean"
    depends_on: ClassVar[tuple[Variable, ...]] = ("tap", "time", "signal")
    any_law: ClassVar[Variable | None] = "time"

    amplitude: tuple[float, ...] = parameter((0.0, 0.01), unit="1", low=-0.9, high=10.0, neutral=())
    time_constant_s: float = parameter(300.0, unit="s", low=1e-3, high=1e9)
    tap_layout: str = parameter("odd_even", unit="", choices=LAYOUTS)

    @classmethod
    def why_not_testable(cls, blocks: Sequence[Block], camera: CameraHeader) -> str | None:
        """Return what a recording lacks to show the drift; None where it could."""
        return first_lack(taps(camera), several_flats(blocks, 2))

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:  # noqa: ARG002
        """DN above the offset in and out, (n_lines, *sample)."""
        if not self.amplitude:
            return signal.copy()
        amplitude = by_tap(self.amplitude, self.tap_layout, signal.shape[1:])
        share = settled(at.line_times_s, self.time_constant_s)
        return signal * (1.0 + amplitude * by_line(share, signal.ndim))

    def check_camera(self, camera: CameraHeader) -> None:
        """Raise InputError unless `amplitude` has one value per tap of the camera."""
        check_taps(self.amplitude, self.tap_layout, camera, "effect tap_gain_drift: amplitude")
