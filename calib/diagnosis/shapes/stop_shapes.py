"""Stops of the codes that the darks of each tap tell: at which level, and how much they let by."""

from collections.abc import Callable, Sequence
from functools import cache

import numpy as np

from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.shapes.dark_codes import DarkCodes, misfit_per_code
from calib.diagnosis.shapes.gathered_darks import dark_codes
from calib.diagnosis.shapes.shape import Shape
from calib.diagnosis.simulation.with_values import with_values
from calib.forward.effects.black_clip import BlackClip

SOFT = (0.0, 0.5)
"""Parts of the distance from the level that are tried of what comes through."""
LOWEST, HIGHEST, STEP = -4.0, 2.0, 0.25
"""Levels about the darks' mean that are tried, in standard deviations of a dark sample."""
MOST = 100.0
"""Deviance that a stop is credited with at the most: counts of codes are Gaussian only nearly."""
FITTED = 2.0
"""Numbers that were fitted: the level, and how much comes through."""
Gain = Callable[[int, float], float]
"""Level and part that comes through in, deviance less than without a stop out."""


def stop_shapes(evidence: Evidence) -> tuple[Shape, ...]:
    """Return a stop at the lowest code, and those of all taps and of each that darks tell."""
    lowest = int(np.flatnonzero(evidence.code_counts.observed)[0])
    plain = Shape(BlackClip(lowest), (), two_sided=False)
    found = {k: each for k, each in enumerate(dark_codes(evidence)) if each is not None}
    if not found:
        return (plain,)
    gains = {k: _gain_of(each) for k, each in found.items()}
    taps: list[int | None] = [None, *gains] if len(gains) > 1 else [None]
    levels = _levels(tuple(found.values()))
    best = {only: _best(only, gains, levels) for only in taps}
    most = max(gain for gain, _ in best.values())
    layout = evidence.sensor.camera.tap_layout
    told = [plain]
    for only, (gain, stop) in best.items():
        credit = gain - most + min(most, MOST)
        if credit > 2.0 * FITTED:
            of_tap = {} if only is None else {"only_tap": only, "tap_layout": layout}
            told.append(
                Shape(with_values(stop, of_tap), (), two_sided=False, freedom=FITTED, credit=credit)
            )
    return tuple(told)


def _best(
    only: int | None, gains: dict[int, Gain], levels: Sequence[int]
) -> tuple[float, BlackClip]:
    """Return by how much the likeliest stop of a tap, or all, is likelier than none, and which."""
    some = [gain for tap, gain in gains.items() if only in {None, tap}]
    step, found = max(int(np.diff(levels).max(initial=1)), 1), []
    for keeps in SOFT:
        tried = {level: sum(gain(level, keeps) for gain in some) for level in levels}
        near = step
        while near >= 1:
            best = max(tried, key=lambda level: tried[level])
            for level in {max(best - near, 1), best + near} - set(tried):
                tried[level] = sum(gain(level, keeps) for gain in some)
            near //= 2
        best = max(tried, key=lambda level: tried[level])
        found.append((tried[best], BlackClip(best, keeps)))
    return max(found, key=lambda pair: pair[0])


def _levels(darks: Sequence[DarkCodes]) -> list[int]:
    middle = float(np.mean([np.average(each.means, weights=each.weight) for each in darks]))
    std = float(np.mean([each.std for each in darks]))
    wanted = np.rint(middle + std * np.arange(LOWEST, HIGHEST, STEP)).astype(int)
    return sorted({max(int(level), 1) for level in wanted})


def _gain_of(darks: DarkCodes) -> Gain:
    plain, _ = darks.deviance(None)

    @cache
    def gain(level: int, keeps: float) -> float:
        after, expected = darks.deviance(BlackClip(level, keeps).faulty)
        return (plain - after) / misfit_per_code(darks, expected)

    return gain
