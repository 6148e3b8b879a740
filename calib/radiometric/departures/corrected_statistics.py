"""Block statistics as the sensor would have shown them without its departures.

    mean'     = mean − (F(θ) − F0(θ))
    variance' = variance · V0(θ) / V(θ)

F and V are mean and variance that the forward model expects of a block with its departures, F0 and
V0 those without, θ the response (DN0, VE·QE, levels). θ comes from the usual estimation on the
corrected statistics, so that both are found in turn: where they stand still, θ makes the sum of
the weighted residuals of F itself vanish along the derivatives of F0. That is least squares of F
but for the departures' share in the derivatives, which costs weight and no bias. A round leaves of
an error what the departure changes of a signal, some percent.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from calib.arrays import Columns
from calib.errors import NotDeterminedError
from calib.forward.model import Model
from calib.radiometric.departures.code_statistics import without_shift
from calib.radiometric.departures.expected_blocks import (
    ExpectedBlock,
    LitBlock,
    block_noise,
    expected_blocks,
)
from calib.radiometric.departures.lit_blocks import lit_blocks
from calib.radiometric.departures.recorded_blocks import RecordedBlock, recorded_blocks
from calib.radiometric.estimation.block_table import BlockTable, Cells
from calib.radiometric.estimation.choices import Choices, no_flats
from calib.radiometric.estimation.parts import Parts, find_parts
from calib.radiometric.estimation.radiance_table import group_levels
from calib.recording.block_statistics import BlockStatistics, RecordingStatistics
from calib.recording.header import RecordingHeader

ROUNDS = 20
SETTLED_SIGMA = 1e-3
"""Means that move by less of their standard errors, as a root mean square, stand still."""


@dataclass(frozen=True)
class Corrected:
    """Statistics without the departures.

    Attributes:
        statistics: Of the lines to fit, and of those held out.
        shift_dn: What departures add to the means, (n_blocks, n_columns).
        shared_noise: Share of a block's variance that all columns of a line have in common,
            (n_blocks,).
    """

    statistics: RecordingStatistics
    shift_dn: Cells
    shared_noise: Columns


@dataclass(frozen=True)
class Settled:
    """Where response and departures agree.

    Attributes:
        parts: The usual estimation of what is left.
        lit: The blocks with that response and their light.
        expected: Of each block.
        shift_dn: What departures add to the means, (n_blocks, n_columns).
    """

    parts: Parts
    lit: tuple[LitBlock, ...]
    expected: tuple[ExpectedBlock, ...]
    shift_dn: Cells


@dataclass(frozen=True)
class _Observed:
    """What does not change from round to round."""

    statistics: RecordingStatistics
    header: RecordingHeader
    model: Model
    choices: Choices
    blocks: tuple[RecordedBlock, ...]
    held_out_every: int


def corrected_statistics(
    statistics: RecordingStatistics,
    header: RecordingHeader,
    model: Model,
    choices: Choices,
    *,
    held_out_every: int,
    start_dn: Cells | None = None,
) -> Corrected:
    """Take the model's departures out of block means and variances; arguments as of `settle`."""
    settled = settle(
        statistics, header, model, choices, held_out_every=held_out_every, start_dn=start_dn
    )
    ratio, shared = _variances(settled.lit, settled.expected)
    fit = without_shift(statistics.fit, settled.shift_dn, ratio, settled.parts)
    rows = [k for k, s in enumerate(statistics.fit) if _held(statistics, s) is not None]
    held = without_shift(statistics.held_out, settled.shift_dn[rows], ratio[rows], settled.parts)
    return Corrected(RecordingStatistics(fit, held), settled.shift_dn, shared)


def settle(
    statistics: RecordingStatistics,
    header: RecordingHeader,
    model: Model,
    choices: Choices,
    *,
    held_out_every: int,
    start_dn: Cells | None = None,
) -> Settled:
    """Find the response and what departures add to the means around it.

    Args:
        statistics: Of the recording.
        header: Of the recording.
        model: Its departures, its lens, its system gain and its noise are used, not its response.
        choices: As for `determine`.
        held_out_every: How lines were split.
        start_dn: The shift to start from; that of nearly the same model saves rounds.

    Raises:
        InputError: As `determine`; `line-period-missing`.
        NotDeterminedError: As `determine`; `departures-too-strong`.
    """
    seen = _observed(statistics, header, model, choices, held_out_every)
    error = np.sqrt(np.array([s.variance_dn2 / s.n_lines for s in statistics.fit]))
    shift = np.zeros_like(error) if start_dn is None else start_dn
    for _ in range(ROUNDS):
        parts = _parts(seen, without_shift(statistics.fit, shift, np.ones_like(shift), None))
        lit = lit_blocks(seen.blocks, statistics.fit, parts, model, header.camera.gain_db)
        expected = tuple(expected_blocks(lit, held_out_every))
        last, shift = shift, _shift(lit, expected)
        if not np.abs(shift).max() < header.camera.full_scale_dn:
            break
        moved = (shift - last)[error > 0] / error[error > 0]
        if np.sqrt(np.mean(moved**2)) < SETTLED_SIGMA:
            return Settled(parts, lit, expected, shift)
    raise NotDeterminedError(
        "The model's departures change the signal so much that no response settles beside them: "
        "check their parameters.",
        code="departures-too-strong",
    )


def _observed(
    statistics: RecordingStatistics,
    header: RecordingHeader,
    model: Model,
    choices: Choices,
    held_out_every: int,
) -> _Observed:
    n_lines = []
    for s in statistics.fit:
        held = _held(statistics, s)
        n_lines.append(s.n_lines + (0 if held is None else held.n_lines))
    told = [s.block for s in statistics.fit]
    blocks = recorded_blocks(told, n_lines, header.camera, model.camera.line_period_us)
    return _Observed(statistics, header, model, choices, blocks, held_out_every)


def _held(statistics: RecordingStatistics, of: BlockStatistics) -> BlockStatistics | None:
    return next((h for h in statistics.held_out if h.block.block == of.block.block), None)


def _parts(seen: _Observed, fit: Sequence[BlockStatistics]) -> Parts:
    """Return the usual estimation of lines, profile and scale."""
    flats, darks = (BlockTable.of_kind(fit, kind) for kind in ("flat", "dark"))
    if not len(flats):
        raise no_flats()
    groups = group_levels(flats.blocks, seen.choices.radiances)
    return find_parts(flats, darks, groups, seen.header, seen.choices)


def _shift(lit: Sequence[LitBlock], expected: Sequence[ExpectedBlock]) -> Cells:
    """Return F − F0, (n_blocks, n_columns)."""
    rows = []
    for one, e in zip(lit, expected, strict=True):
        plain = replace(one.chain, departures=())
        without, _ = plain.expected(one.light, one.recorded.at(None, 0, 1))
        rows.append(e.mean_dn - without[0])
    return np.array(rows)


def _variances(lit: Sequence[LitBlock], expected: Sequence[ExpectedBlock]) -> tuple[Cells, Columns]:
    """Return V0 / V, 1 where there is no noise, (n_blocks, n_columns).

    Also the share of V that all columns of a line have in common, (n_blocks,).
    """
    ratio, shared = [], []
    for k, (one, e) in enumerate(zip(lit, expected, strict=True)):
        noise = block_noise(one, e.before, k)
        total = noise.with_departures + e.line_variance_dn2
        known = (total > 0) & (noise.without > 0)
        ratio.append(np.divide(noise.without, total, out=np.ones_like(total), where=known))
        shared.append(noise.shared / max(float(total.mean()), 1e-300))
    return np.array(ratio), np.array(shared)
