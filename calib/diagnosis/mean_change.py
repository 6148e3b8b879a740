"""What effects change in the means of all pixels, in those of first lines, and in tones."""

from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from calib.arrays import Columns
from calib.diagnosis.chain_run import FittedChain
from calib.diagnosis.pooled import ONSET_LINES
from calib.diagnosis.tones import Peak
from calib.diagnosis.with_values import with_values
from calib.forward.departure import Departure
from calib.forward.effect import Effect
from calib.forward.left import Left

Floats = NDArray[np.float64]

TONE_LINES = 48
"""So many lines, or all of a block, tell a tone."""


def mean_change(
    chain: FittedChain, effects: Sequence[Effect], lefts: Sequence[Left | None], draw: int
) -> tuple[Floats, Floats]:
    """Return the change of means, (n_blocks, n_pixels), and of first lines', (n_blocks, 3).

    A tone leaves nothing in the means of a whole block.
    """
    effects = tuple(_undivided(effect) for effect in effects if not is_tone(effect))
    if any(_remembers(e) or chain.has_events(e) for e in effects):
        found = _by_stretches(chain, effects, lefts, draw)
    else:
        found = _by_three(chain, effects, draw)
    plain = chain.baseline.mean_dn.reshape(len(found), -1)
    means, onset = [], np.zeros((len(found), ONSET_LINES))
    for b, (lines, weights, first) in enumerate(found):
        change = lines - plain[b]
        means.append(weights @ change)
        onset[b, : len(first)] = first @ change.mean(axis=1)
    return np.stack(means), onset


def tone_change(chain: FittedChain, effects: Sequence[Effect], peaks: Sequence[Peak]) -> Floats:
    """Return squared amplitudes at the peaks that effects of the spectrum give, DN^2."""
    tonal = [effect for effect in effects if is_tone(effect)]
    found = np.zeros((len(chain.table.blocks), len(peaks)))
    if not tonal or not peaks:
        return found
    n = [min(int(lines), TONE_LINES) for lines in chain.table.n_lines]
    stack = chain.stack([(b, np.arange(float(k))) for b, k in enumerate(n)], "tone")
    lines = chain.noise_free(stack, tonal, 0)
    for b, where in enumerate(stack.parts):
        change = lines[where] - chain.baseline.mean_dn[b].ravel()
        found[b] = [peak.squared_amplitude(change) for peak in peaks]
    return found


def is_tone(effect: Effect) -> bool:
    """Return whether an effect shows in the spectrum first."""
    return isinstance(effect, Departure) and effect.shows_in == "spectrum"


_Weighed = tuple[Floats, Columns, Floats]
"""Lines, (n, n_pixels), their weights in the block's mean, (n,), and in its first lines, (k, n)."""


def _by_three(chain: FittedChain, effects: Sequence[Effect], draw: int) -> list[_Weighed]:
    """Return first, middle and last lines: what changes within a block does so smoothly.

    Their weights are Simpson's; first lines lie on the parabola through the three.
    """
    counts = chain.table.n_lines.astype(int).tolist()
    lines = [(b, np.array([0.0, (n - 1) / 2, n - 1.0])) for b, n in enumerate(counts)]
    stack = chain.stack(lines, "three")
    found = chain.noise_free(stack, effects, draw)
    simpson = np.array([1.0, 4.0, 1.0]) / 6.0
    return [
        (found[where], simpson, _parabola(n)) for where, n in zip(stack.parts, counts, strict=True)
    ]


@lru_cache
def _parabola(n: int) -> Floats:
    """Return the weights of three lines in the first ones less the later half's mean, (k, 3)."""
    t = np.arange(n) / max(n - 1, 1)
    basis = np.stack([(1 - t) * (1 - 2 * t), 4 * t * (1 - t), t * (2 * t - 1)], axis=1)
    return np.asarray(basis[:ONSET_LINES] - basis[n // 2 :].mean(axis=0))


def _by_stretches(
    chain: FittedChain, effects: Sequence[Effect], lefts: Sequence[Left | None], draw: int
) -> list[_Weighed]:
    """Return the first lines and some others, which find in the pixels what those before left."""
    lines: list[tuple[int, Columns]] = []
    before: list[Left | None] = []
    weights = []
    for b, n in enumerate(chain.table.n_lines.astype(int).tolist()):
        stretches, weight = spread_lines(n)
        weights.append(weight)
        left = _as_it_is(lefts[b], effects)
        for each in stretches:
            lines.append((b, each))
            kept = chain.left_after(b, int(each[0]), effects, left)
            before.append(_as_it_is(kept, effects))
    stack = chain.stack(lines, "spread").before(before)
    found = chain.noise_free(stack, effects, draw)
    parts = np.split(found, np.cumsum([len(w) for w in weights])[:-1])
    return [(part, w, _first(len(w))) for part, w in zip(parts, weights, strict=True)]


@lru_cache
def _first(n: int) -> Floats:
    """Return the weights of lines in the first ones less the later half's mean, (k, n)."""
    later = np.where(np.arange(n) >= n // 2, 1.0 / (n - n // 2), 0.0)
    return np.asarray(np.eye(n)[:ONSET_LINES] - later)


@lru_cache
def spread_lines(n: int) -> tuple[tuple[Columns, ...], Columns]:
    """Return stretches of lines that stand for a block of `n`, and the weight of each line.

    The first lines count for themselves, since there a step from the block before shows.
    """
    if n <= 16:
        return (np.arange(n, dtype=np.float64),), np.full(n, 1.0 / n)
    starts = (0, n // 8, n // 4, n // 2, 3 * n // 4, n - 2)
    lengths = (6, 1, 1, 2, 1, 2)
    stretches: list[Columns] = []
    for start, length in zip(starts, lengths, strict=True):
        first = max(start, int(stretches[-1][-1]) + 1 if stretches else 0)
        stretches.append(np.arange(first, min(first + length, n), dtype=np.float64))
    lines = np.concatenate(stretches)
    edges = np.concatenate([[-0.5], (lines[1:] + lines[:-1]) / 2, [n - 0.5]])
    return tuple(s for s in stretches if len(s)), np.diff(edges) / n


def _undivided(effect: Effect) -> Effect:
    """Return the effect with charge parted exactly by its share: what it does on average."""
    if not isinstance(effect, Departure) or not hasattr(effect, "partition_noise"):
        return effect
    return with_values(effect, {"partition_noise": 0.0})


def _as_it_is(left: Left | None, effects: Sequence[Effect]) -> Left | None:
    """Return what was left on average as if drawn, where no effect takes it for whole electrons."""
    if left is None or not all(hasattr(e, "partition_noise") for e in effects if _remembers(e)):
        return left
    return replace(left, drawn=True)


def _remembers(effect: Effect) -> bool:
    return hasattr(effect, "carry")
