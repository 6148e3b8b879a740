"""What a coefficient set makes of one block of a recording: the same lines before and after."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import cast

import numpy as np
from numpy.typing import NDArray

from calib.arrays import Columns, Lines, RawLines
from calib.errors import InputError
from calib.radiometric.coefficients.coefficient_set import CoefficientSet
from calib.radiometric.correction.apply_options import ApplyOptions
from calib.radiometric.correction.flags import Flag
from calib.radiometric.correction.inversion import remembers
from calib.radiometric.uniformity import HELD_OUT_EVERY, held_out_lines, variation_percent
from calib.recording.header import Block
from calib.recording.protocol import Recording

MOST_LINES = 512
"""So many are looked at: of 6144 columns some 20 ms of work."""
_RESTED = "Pixels of this set remember earlier light: the sensor is taken to have rested before."
_UNUSABLE = Flag.MASKED | Flag.SATURATED


@dataclass(frozen=True)
class Variation:
    """Coefficients of variation along the columns, percent.

    Attributes:
        mean_line: Of the mean of all lines: what is fixed, and the noise that is left of so many.
        single_line: Median over single lines: with a line's temporal noise.
    """

    mean_line: float
    single_line: float


@dataclass(frozen=True, eq=False)
class CorrectedBlock:
    """Lines of a block, raw and as radiance.

    Attributes:
        block: Which one.
        raw_dn: The lines, (n_lines, n_columns).
        radiance: The same, (n_lines, n_columns), in the set's unit; NaN in masked columns.
        mean_std: Standard uncertainty of their mean's radiance, the scale's included, (n_columns,).
        used: Columns that have coefficients and saturate in no line, (n_columns,); the variations
            are over these.
        before: Of the codes.
        without_vignette: Of the codes divided by VE: AgCam's "before" (section 5.4).
        after: Of the radiance.
        noise_percent: What temporal noise alone leaves in the mean line's radiance: the root mean
            square of its columns' standard errors, as the lines scatter, over its mean.
        notes: What a reader has to know, one sentence each.
    """

    block: Block
    raw_dn: RawLines
    radiance: Lines
    mean_std: Columns
    used: NDArray[np.bool_]
    before: Variation
    without_vignette: Variation
    after: Variation
    noise_percent: float
    notes: tuple[str, ...]


def blocks_to_show(recording: Recording) -> tuple[Block, ...]:
    """Return the blocks that have light in them, in the order of acquisition."""
    return tuple(block for block in recording.header.blocks if block.kind != "dark")


def block_in_the_middle(blocks: Sequence[Block]) -> Block:
    """Return the block whose light, exposure times level, is the median of all."""
    by_light = sorted(blocks, key=lambda block: block.exposure_us * block.level)
    return by_light[len(by_light) // 2]


def corrected_block(
    recording: Recording, coefficients: CoefficientSet, block: Block, *, is_own: bool
) -> CorrectedBlock:
    """Correct the first lines of `block`, at most `MOST_LINES`.

    Args:
        recording: Of the sensor that the set is of.
        coefficients: The set.
        block: One of the recording's.
        is_own: Whether the set was made of this recording: then the lines are those that had no
            part in its fit, for others are fitted better than any to come.

    Raises:
        InputError: The set does not match the recording (`set-mismatch`, `wrong-columns`), the
            sensor is an area sensor (`area-sensor`), the block has fewer than two such lines
            (`too-few-lines`), or hardly a column of it can be used (`all-saturated`).
    """
    if recording.header.camera.rows is not None:
        msg = "a coefficient set corrects lines, and this recording is of an area sensor"
        raise InputError(msg, code="area-sensor")
    frames = recording.frames(block.block)
    raw = _first_lines(held_out_lines(frames, HELD_OUT_EVERY) if is_own else frames)
    if len(raw) < 2:
        msg = f"block {block.block} has {len(raw)} lines to judge a set by; take one with more"
        raise InputError(msg, code="too-few-lines")
    correction = ApplyOptions().correction(recording, block, coefficients)
    mean = correction.mean_line(raw)
    used = (mean.flags[0] & _UNUSABLE) == 0
    if used.sum() < 2:
        msg = f"block {block.block} saturates: choose one with less light"
        raise InputError(msg, code="all-saturated")
    std = cast("NDArray[np.float32]", mean.std)[0]
    radiance = correction.lines(raw, std=False).radiance
    notes = correction.notes + ((_RESTED,) if remembers(coefficients) else ())
    return CorrectedBlock(
        block, raw, radiance, std.astype(np.float64), used,
        before=_variation(raw[:, used]),
        without_vignette=_variation(raw[:, used] / coefficients.vignette[used]),
        after=_variation(radiance[:, used]),
        noise_percent=_noise_percent(radiance[:, used]),
        notes=notes,
    )  # fmt: skip


def _first_lines(frames: Iterator[RawLines]) -> RawLines:
    """Return the first lines, copied out of their frames: (n_lines, n_columns)."""
    taken: list[RawLines] = []
    left = MOST_LINES
    for frame in frames:
        taken.append(frame[:left].copy())
        left -= len(taken[-1])
        if left == 0:
            break
    return cast("RawLines", np.concatenate(taken)) if taken else np.zeros((0, 0), np.uint8)


def _variation(lines: Lines | RawLines) -> Variation:
    values = lines.astype(np.float64)
    return Variation(
        mean_line=float(variation_percent(values.mean(axis=0, keepdims=True))[0]),
        single_line=float(np.median(variation_percent(values))),
    )


def _noise_percent(radiance: Lines) -> float:
    values = radiance.astype(np.float64)
    of_mean = values.var(axis=0, ddof=1).mean() / len(values)
    return float(100.0 * np.sqrt(of_mean) / values.mean())
