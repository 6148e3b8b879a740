"""An effect's numbers, ready for a sentence."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from calib.diagnosis.answer.estimate import Estimate
from calib.diagnosis.words.scales import RecordingScales
from calib.forward.departure import Departure
from calib.forward.drift import settled
from calib.forward.effects.cti import transfers_of_column
from calib.report.rounded import number, percent, printed_unit

DIGITS = 1
"""Of an uncertainty, as far as a sentence goes; tables give two."""
SURE = 0.01
"""Nor does a sentence give more digits than this relative uncertainty asks for."""


@dataclass(frozen=True)
class Telling:
    """What a sentence may ask for.

    Attributes:
        effect: As fitted.
        estimates: Those of its parameters that were fitted.
        scales: Of the recording.
    """

    effect: Departure
    estimates: Mapping[str, Estimate]
    scales: RecordingScales

    def value(self, name: str) -> float:
        """Return a parameter; of one value per tap, the one that is farthest from 0."""
        value = getattr(self.effect, name)
        if isinstance(value, tuple):
            return float(max(value, key=abs, default=0.0))
        return float(value)

    def word(self, name: str) -> str:
        """Return a parameter that is a word."""
        return str(getattr(self.effect, name))

    def share(self, name: str) -> str:
        """Return the size of a parameter in percent."""
        return percent(abs(self.value(name)), self._std(name), digits=DIGITS)

    def size(self, name: str, unit: str) -> str:
        """Return the size of a parameter with its unit."""
        return self._with_unit(number(abs(self.value(name)), self._std(name), digits=DIGITS), unit)

    def scaled(self, name: str, factor: float, unit: str) -> str:
        """Return the size of a parameter times a factor, in the unit of the product."""
        value, std = abs(self.value(name) * factor), self._std(name) * abs(factor)
        return self._with_unit(number(value, std, digits=DIGITS), unit)

    def scaled_share(self, name: str, factor: float) -> str:
        """Return the size of a parameter times a factor in percent."""
        std = self._std(name) * abs(factor)
        return percent(abs(self.value(name) * factor), std, digits=DIGITS)

    def either(self, name: str, positive: str, negative: str) -> str:
        """Return a word by the sign of a parameter."""
        return positive if self.value(name) >= 0 else negative

    def most_transfers(self, readout: str, tap_layout: str) -> float:
        """Return how many transfers take the charge there that is farthest from its output."""
        return float(transfers_of_column(readout, self.scales.columns, tap_layout).max())

    @property
    def settled(self) -> float:
        """Return which part of its amplitude a drift has reached at the recording's end."""
        end = np.array([self.scales.duration_s])
        return float(settled(end, self.value("time_constant_s"))[0])

    @property
    def largest_inl_dn(self) -> float:
        """Return by how much codes lie off a straight line at most."""
        codes = np.linspace(0.0, self.scales.full_scale_dn, 513)
        x = np.pi * codes / self.scales.full_scale_dn
        heights = (self.value("bow_dn"), self.value("s_dn"), self.value("w_dn"))
        return float(np.abs(sum(h * np.sin(k * x) for k, h in enumerate(heights, start=1))).max())

    def _std(self, name: str) -> float:
        found = self.estimates.get(name)
        return math.nan if found is None else max(found.std, SURE * abs(found.value))

    def _with_unit(self, text: str, unit: str) -> str:
        printed = printed_unit(unit)
        return f"{text} {printed}" if printed else text


Sentence = Callable[[Telling], str]
"""What an operator is told of an effect."""
