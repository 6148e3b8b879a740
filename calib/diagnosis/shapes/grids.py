"""The values that are tried of parameters, from their units and a recording's own scales."""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from math import inf

import numpy as np

from calib.diagnosis.simulation.with_values import with_values
from calib.forward.departure import Departure
from calib.forward.parameter import Parameter
from calib.recording.header import CameraHeader

MOST_TOGETHER = 12
"""Grids of several parameters are crossed up to so many shapes."""
MAINS_HZ = (50.0, 60.0)
"""Frequencies of the world's mains (IEC 60196), which grids hold to 1 % or better (EN 50160)."""
TONE_WIDTH = 0.75
"""Over a block's lines: by so many cycles a line a peak may lie off its tone."""


@dataclass(frozen=True)
class Scales:
    """What sizes a recording has.

    Attributes:
        camera: The camera.
        duration_s: From its start to its end.
        line_period_s: From line to line.
        most_e: The largest mean charge.
        radiance: The largest radiance.
        tones_hz: Frequencies that stand out of the spectrum.
        n_lines: Of a block.
    """

    camera: CameraHeader
    duration_s: float
    line_period_s: float
    most_e: float
    radiance: float
    tones_hz: tuple[float, ...]
    n_lines: int = 1

    @property
    def mains_hz(self) -> tuple[float, ...]:
        """What may be the mains' frequency: 50 or 60 Hz where a tone is what they look like.

        Lines see a tone folded to half their rate at most: what it is, they do not tell.
        """
        seen = [self._cycles_per_line(2.0 * tone) for tone in self.tones_hz]
        width = TONE_WIDTH / self.n_lines
        known = tuple(
            hz
            for hz in MAINS_HZ
            if any(abs(self._cycles_per_line(2.0 * hz) - s) < width for s in seen)
        )
        return known or self.tones_hz

    def _cycles_per_line(self, hz: float) -> float:
        turns = hz * self.line_period_s
        return abs(turns - round(turns))


def star(default: Departure, grids: dict[str, tuple[object, ...]]) -> list[Departure]:
    """Return the effect with one parameter at a time off its first value; few, all of them."""
    times = {n: g for n, g in grids.items() if n.endswith("_s")}
    if len(times) > 1:
        # Several times of one effect are tried together.
        others = {n: g for n, g in grids.items() if n not in times}
        return [
            with_values(one, dict(zip(times, values, strict=True)))
            for values in zip(*times.values(), strict=True)
            for one in star(default, others)
        ]
    if np.prod([len(g) for g in grids.values()]) <= MOST_TOGETHER:
        return [
            with_values(default, dict(zip(grids, values, strict=True)))
            for values in itertools.product(*grids.values())
        ]
    first = with_values(default, {n: g[0] for n, g in grids.items()})
    return [first] + [with_values(first, {n: v}) for n, g in grids.items() for v in g[1:]]


def grid(
    name: str, value: object, told: Parameter, scales: Scales, remembers: bool
) -> tuple[object, ...]:
    """Return the values of a parameter that are tried, the likeliest first."""
    if told.choices:
        of_frames = name == "shared_by" and scales.camera.rows is None
        return (value,) if of_frames or name in {"tap_layout", "readout"} else told.choices
    if isinstance(value, bool):
        return (False,) if name == "each_tap" and scales.camera.taps < 2 else (False, True)
    if isinstance(value, int):
        return _whole(name, value, told, scales)
    if isinstance(value, float):
        if name == "mains_hz":
            return _within(scales.mains_hz or (value,), told)
        return _within(_scaled(value, told, scales, remembers), told)
    return (value,)


def _whole(name: str, value: int, told: Parameter, scales: Scales) -> tuple[object, ...]:
    if name.endswith("seed") or name == "bit_depth":
        return (value,)
    if told.unit == "bit":
        return tuple(range(min(scales.camera.bit_depth, 8)))
    if told.high - told.low <= 4:
        return tuple(range(int(told.low), int(told.high) + 1))
    return (value,)


def _scaled(  # noqa: PLR0911 - one for each unit
    value: float, told: Parameter, scales: Scales, remembers: bool
) -> tuple[float, ...]:
    if told.unit == "s":
        d, p = scales.duration_s, scales.line_period_s
        # What a pixel remembers may fade within lines; what drifts does so over blocks.
        ladder = (0.2 * d, 0.04 * d, 0.008 * d, d, 30.0 * p, 3.0 * p)
        return ladder if remembers else (d, 0.15 * d, 10.0 * d)
    if told.unit == "Hz":
        return scales.tones_hz or (value,)
    if told.unit == "e-":
        if told.neutral == inf:
            return tuple(scales.most_e * share for share in (0.8, 0.6, 0.4, 0.9))
        if remembers and told.low >= 1.0 and told.high >= 1e9:
            # Traps that a block fills, by half and more where it is bright.
            return (scales.most_e * scales.n_lines,)
        if told.low >= 1.0 and told.high >= 1e9:
            return tuple(scales.most_e * share for share in (1.0, 10.0, 100.0))
        return (value,)
    if told.unit == "column":
        c = scales.camera.columns
        return (0.2 * c, 0.05 * c, 0.6 * c) if value > 10 else (value, 3.0 * value)
    if told.unit == "radiance":
        return (scales.radiance / 2.0,)
    if told.unit == "1" and told.low == 0.0 and told.high == value == 1.0:
        return (1.0, 0.0)
    return (value,)


def _within(values: Sequence[float], told: Parameter) -> tuple[float, ...]:
    held = (min(max(v, told.low), told.high) for v in values)
    return tuple(dict.fromkeys(held))
