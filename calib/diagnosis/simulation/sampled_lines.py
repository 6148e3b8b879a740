"""Noise-free lines that stand for a whole block: what effects change without any chance.

What changes smoothly within a block is told by three lines, what starts anew in each block by its
first lines and a few later ones, between which it runs smoothly.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from calib.arrays import Columns
from calib.diagnosis.simulation.chain_run import FittedChain
from calib.diagnosis.simulation.with_values import with_values
from calib.diagnosis.statistics.pooled import ONSET_LINES
from calib.forward.departure import Departure
from calib.forward.effect import Effect
from calib.forward.left import Left
from calib.forward.remembering import Remembering

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class SampledLines:
    """Some lines of a block.

    Attributes:
        change: Their change, DN, (k, n_pixels).
        weights: Of each in the block's mean, (k,).
        first: Weights in the first lines' means less the later half's, (3 or fewer, k).
        between: Weights with which each of the block's lines is made of them, (n_lines, k).
    """

    change: Floats
    weights: Columns
    first: Floats
    between: Floats


def sampled_lines(
    chain: FittedChain, effects: Sequence[Effect], lefts: Sequence[Left | None], draw: int
) -> list[SampledLines]:
    """Return lines of each block; a tone leaves nothing in them, and is left out."""
    effects = tuple(_undivided(effect) for effect in effects if not is_tone(effect))
    if any(isinstance(e, Remembering) or chain.has_events(e) for e in effects):
        return _by_stretches(chain, effects, lefts, draw)
    return _by_three(chain, effects, draw)


def is_tone(effect: Effect) -> bool:
    """Return whether an effect shows in the spectrum first."""
    return isinstance(effect, Departure) and effect.shows_in == "spectrum"


def _by_three(chain: FittedChain, effects: Sequence[Effect], draw: int) -> list[SampledLines]:
    """Return first, middle and last lines, with Simpson's weights, on a parabola."""
    counts = chain.table.n_lines.astype(int).tolist()
    lines = [(b, np.array([0.0, (n - 1) / 2, n - 1.0])) for b, n in enumerate(counts)]
    stack = chain.stack(lines, "three")
    found = chain.noise_free(stack, effects, draw)
    simpson = np.array([1.0, 4.0, 1.0]) / 6.0
    sampled = []
    for b, (where, n) in enumerate(zip(stack.parts, counts, strict=True)):
        basis = _parabola(n)
        first = basis[:ONSET_LINES] - basis[n // 2 :].mean(axis=0)
        change = found[where] - chain.baseline.mean_dn[b].ravel()
        sampled.append(SampledLines(change, simpson, first, basis))
    return sampled


@lru_cache
def _parabola(n: int) -> Floats:
    """Return the weights of first, middle and last in each line, (n, 3)."""
    t = np.arange(n) / max(n - 1, 1)
    return np.stack([(1 - t) * (1 - 2 * t), 4 * t * (1 - t), t * (2 * t - 1)], axis=1)


def _by_stretches(
    chain: FittedChain, effects: Sequence[Effect], lefts: Sequence[Left | None], draw: int
) -> list[SampledLines]:
    """Return the first lines and some others, which find in the pixels what those before left."""
    lines: list[tuple[int, Columns]] = []
    before: list[Left | None] = []
    counts = chain.table.n_lines.astype(int).tolist()
    for b, n in enumerate(counts):
        left = _as_it_is(lefts[b], effects)
        for each in spread_lines(n):
            lines.append((b, each))
            kept = chain.left_after(b, int(each[0]), effects, left)
            before.append(_as_it_is(kept, effects))
    stack = chain.stack(lines, "spread").before(before)
    found = chain.noise_free(stack, effects, draw)
    sampled, start = [], 0
    for b, n in enumerate(counts):
        between = _smooth(n)
        stop = start + between.shape[1]
        change = found[start:stop] - chain.baseline.mean_dn[b].ravel()
        sampled.append(SampledLines(change, between.mean(axis=0), _first(between), between))
        start = stop
    return sampled


def _first(between: Floats) -> Floats:
    """Return the weights of lines in the first ones less the later half's mean, (3 or fewer, k)."""
    return np.asarray(between[:ONSET_LINES] - between[len(between) // 2 :].mean(axis=0))


@lru_cache
def _smooth(n: int) -> Floats:
    """Return the weights of spread lines in each of `n` lines, (n, k).

    The first lines are as they are, and a step in them is over; cubics run from the last of them.
    """
    stretches = spread_lines(n)
    lines, steps = np.concatenate(stretches), len(stretches[0]) - 1
    if len(lines) == n:
        return np.eye(n)
    between = np.zeros((n, len(lines)))
    between[:steps, :steps] = np.eye(steps)
    later = CubicSpline(lines[steps:], np.eye(len(lines) - steps), bc_type="natural")
    between[steps:, steps:] = later(np.arange(steps, n))
    return between


@lru_cache
def spread_lines(n: int) -> tuple[Columns, ...]:
    """Return stretches of lines that stand for a block of `n`.

    The first lines count for themselves, since there a step from the block before shows.
    """
    if n <= 16:
        return (np.arange(n, dtype=np.float64),)
    starts = (0, n // 16, n // 8, n // 4, n // 2, 3 * n // 4, n - 2)
    lengths = (6, 1, 1, 1, 2, 1, 2)
    stretches: list[Columns] = []
    for start, length in zip(starts, lengths, strict=True):
        first = max(start, int(stretches[-1][-1]) + 1 if stretches else 0)
        stretches.append(np.arange(first, min(first + length, n), dtype=np.float64))
    return tuple(s for s in stretches if len(s))


def _undivided(effect: Effect) -> Effect:
    """Return the effect with charge parted exactly by its share: what it does on average."""
    if not isinstance(effect, Departure) or not hasattr(effect, "partition_noise"):
        return effect
    return with_values(effect, {"partition_noise": 0.0})


def _as_it_is(left: Left | None, effects: Sequence[Effect]) -> Left | None:
    """Return what was left on average as if drawn, where no effect takes it for whole electrons."""
    memories = [effect for effect in effects if isinstance(effect, Remembering)]
    if left is None or not all(hasattr(effect, "partition_noise") for effect in memories):
        return left
    return replace(left, drawn=True)
