"""Differential nonlinearity (DNL) of the converter: some codes are wide, some narrow or missing.

Source: IEEE Std 1241-2010, Terminology and test methods for analog-to-digital converters: a code's
width is the distance between its two transitions, its DNL that width less its mean, 1. Each
transition is off by a normal number of its own, as where each has a comparator of its own: then
the codes' means stay right. A transition that falls below the one before leaves a code missing.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import sqrt
from typing import ClassVar

import numpy as np
from numpy.random import Generator

from calib.arrays import Columns, Lines
from calib.errors import InputError
from calib.forward.conditions import Conditions
from calib.forward.departure import Departure, Statistic, Variable
from calib.forward.effect import Stage
from calib.forward.effects.adc import check_bit_depth
from calib.forward.parameter import parameter
from calib.forward.pattern import pattern_generator
from calib.forward.plan_needs import lines
from calib.kernels.stretched_codes import stretched_codes
from calib.recording.header import Block, CameraHeader


@dataclass(frozen=True)
class AdcDnl(Departure):
    """Stretch each code's interval of DN to the width 1 that `adc` gives it when it rounds.

    So rounding stays in one place, and a missing code has no interval at all. What lies below the
    lowest code or above the highest stays there, for `adc` to clip.

    Attributes:
        width_std_dn: Standard deviation of the code widths as long as few are missing.
        missing_share: Share of the codes that are missing besides; the code below takes its place.
        seed: Which converter of that kind it is.
        widths_dn: Width of each code, or of the first that all others repeat; where given, in
            place of drawn ones. Scaled to a mean of 1.
        bit_depth: That of the camera.
    """

    name: ClassVar[str] = "adc_dnl"
    stage: ClassVar[Stage] = Stage.CODES
    stochastic: ClassVar[bool] = False
    by_signal: ClassVar[bool] = True
    physics: ClassVar[str] = "Some codes are wide, some narrow or missing; their mean width is 1."
    shows_in: ClassVar[Statistic] = "histogram"
    depends_on: ClassVar[tuple[Variable, ...]] = ("code",)

    width_std_dn: float = parameter(0.2, unit="DN", low=0.0, high=10.0, neutral=0.0)
    missing_share: float = parameter(0.0, unit="1", low=0.0, high=0.5, neutral=0.0)
    seed: int = parameter(0, unit="1", low=0)
    widths_dn: tuple[float, ...] = parameter((), unit="DN", low=0.0, high=1e5)
    bit_depth: int = parameter(12, unit="bit", low=8, high=16)

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:  # noqa: ARG002
        """DN in and out, not yet rounded, (n_lines, *sample)."""
        if not (self.widths_dn or self.width_std_dn or self.missing_share):
            return signal.copy()
        return stretched_codes(signal, _edges(self))

    def widths(self) -> Columns:
        """Return the width of each code, DN, (2^bit_depth,), of mean 1."""
        return np.asarray(np.diff(_edges(self)))

    def check_camera(self, camera: CameraHeader) -> None:
        """Raise InputError unless the camera has this bit depth, and each code a width."""
        check_bit_depth(self.bit_depth, camera, f"effect {self.name}")
        n_codes = 1 << self.bit_depth
        if self.widths_dn and n_codes % len(self.widths_dn):
            raise InputError(
                f"effect {self.name}: widths_dn has {len(self.widths_dn)} values; give {n_codes}, "
                "or as many of the first as divide that, which all others repeat.",
                code="wrong-length",
            )
        if self.widths_dn and not any(self.widths_dn):
            raise InputError(
                f"effect {self.name}: widths_dn are all 0; give some code a width.",
                code="no-such-code",
            )

    @classmethod
    def why_not_testable(cls, blocks: Sequence[Block], camera: CameraHeader) -> str | None:  # noqa: ARG003
        """Return what `blocks` lack: lines to make a histogram of."""
        return lines(blocks, 2)


@lru_cache(maxsize=8)
def _edges(dnl: AdcDnl) -> Columns:
    """Return where each code begins and the last ends, DN, (2^bit_depth + 1,), ascending."""
    n_codes = 1 << dnl.bit_depth
    edges = np.arange(n_codes + 1, dtype=np.float64) - 0.5
    if dnl.widths_dn:
        widths = np.resize(np.asarray(dnl.widths_dn, dtype=np.float64), n_codes)
        edges[1:] = np.cumsum(widths) * (n_codes / widths.sum()) - 0.5
    else:
        rng = pattern_generator(dnl.seed, dnl.name)
        edges[1:-1] += dnl.width_std_dn / sqrt(2) * rng.standard_normal(n_codes - 1)
        edges = np.maximum.accumulate(np.clip(edges, -0.5, n_codes - 0.5))
        missing = np.flatnonzero(rng.random(n_codes) < dnl.missing_share)
        for code in missing[(missing > 0) & (missing < n_codes - 1)][::-1]:
            edges[code] = edges[code + 1]
    edges.flags.writeable = False
    return edges
