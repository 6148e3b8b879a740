"""What departures do to the block means and temporal variances of a recording.

    mean        average over the lines of the chain's expectation
    variance    that of the expectation from line to line, and the noise about it

(the law of total variance). The expectation is run over every line, since a few lines after a step
of the light weigh little in a mean but much in a variance. The noise is drawn on some lines with
and without the departures, from the same random numbers.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from calib.arrays import Columns
from calib.forward.conditions import Conditions
from calib.forward.left import Left
from calib.radiometric.departures.fitted_chain import FittedChain
from calib.radiometric.departures.recorded_blocks import RecordedBlock

_SAMPLES_AT_ONCE = 1 << 20
_SAMPLES_DRAWN = 1 << 17
_FEWEST_DRAWN, _MOST_DRAWN = 32, 512


@dataclass(frozen=True)
class LitBlock:
    """A block, the chain at its exposure, and the light in it.

    Attributes:
        recorded: Its conditions.
        chain: With the response at its exposure.
        light: Radiance, (n_columns,); 0 in the dark.
    """

    recorded: RecordedBlock
    chain: FittedChain
    light: Columns


@dataclass(frozen=True)
class ExpectedBlock:
    """Of a block, each (n_columns,).

    Attributes:
        mean_dn: Of the lines that are asked for.
        line_variance_dn2: Of the expectation among those lines.
        before: What the block finds in the pixels; None for a sensor at rest.
        left: What it leaves there; None where nothing remembers.
    """

    mean_dn: Columns
    line_variance_dn2: Columns
    before: Left | None
    left: Left | None


def expected_blocks(blocks: Sequence[LitBlock], held_out_every: int) -> Iterator[ExpectedBlock]:
    """Yield each block's expectation over its lines but each `held_out_every`-th one."""
    left = None
    for lit in blocks:
        expected = _expected(lit, left, held_out_every)
        left = expected.left
        yield expected


def _expected(lit: LitBlock, before: Left | None, held_out_every: int) -> ExpectedBlock:
    left = before
    at_once = max(1, _SAMPLES_AT_ONCE // len(lit.light))
    n_lines, start = 0, np.zeros(len(lit.light))
    total, squares = np.zeros((2, len(lit.light)))
    for first in range(0, lit.recorded.n_lines, at_once):
        stop = min(first + at_once, lit.recorded.n_lines)
        dn, left = lit.chain.expected(lit.light, lit.recorded.at(left, first, stop))
        number = np.arange(first, stop)
        used = dn[number % held_out_every != held_out_every - 1] if held_out_every else dn
        start = dn[-1] if first == 0 else start  # differences lose no digits in their squares
        n_lines += len(used)
        total += (used - start).sum(axis=0)
        squares += ((used - start) ** 2).sum(axis=0)
    away = total / max(n_lines, 1)
    variance = (squares - n_lines * away**2) / max(n_lines - 1, 1)
    return ExpectedBlock(start + away, np.maximum(variance, 0.0), before, left)


@dataclass(frozen=True)
class BlockNoise:
    """Noise about the expectation, DN^2.

    Attributes:
        with_departures: (n_columns,).
        without: (n_columns,).
        shared: The part of the former that all columns of a line have in common.
    """

    with_departures: Columns
    without: Columns
    shared: float


def block_noise(lit: LitBlock, before: Left | None, seed: int) -> BlockNoise:
    """Return the noise of a block with and without its departures.

    Drawn are lines in the middle of the block, or all of it several times.

    Args:
        lit: The block.
        before: What it finds in the pixels.
        seed: Of the random numbers that both have in common.
    """
    wanted = int(np.clip(_SAMPLES_DRAWN // len(lit.light), _FEWEST_DRAWN, _MOST_DRAWN))
    n_lines = lit.recorded.n_lines
    n_drawn = min(n_lines, wanted)
    first = (n_lines - n_drawn) // 2
    if first:
        _, before = lit.chain.expected(lit.light, lit.recorded.at(before, 0, first))
    at = lit.recorded.at(before, first, first + n_drawn)
    seeds = [[seed, k] for k in range(-(-wanted // n_drawn))]
    plain = replace(lit.chain, departures=())
    seen, without = (_about_expectation(c, lit.light, at, seeds) for c in (lit.chain, plain))
    variance = seen.var(axis=0, ddof=1)
    shared = float(seen.mean(axis=1).var(ddof=1) - variance.mean() / len(variance))
    return BlockNoise(variance, without.var(axis=0, ddof=1), max(shared, 0.0))


def _about_expectation(
    chain: FittedChain, light: Columns, at: Conditions, seeds: Sequence[list[int]]
) -> NDArray[np.float64]:
    """Return drawn lines less what is expected of them, (n_drawn, n_columns)."""
    expected, _ = chain.expected(light, at)
    return np.concatenate([np.asarray(chain.drawn(light, at, s)) - expected for s in seeds])
