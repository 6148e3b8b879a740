"""How uniform a uniform source looks before and after the correction.

AgCam (Olsen et al. 2010), section 5.4: the coefficient of variation along the columns, before the
correction of the raw DN divided by VE, after it of the radiance. It is taken of the mean line and,
since the paper does not say which it prints, as the median over single lines too; from lines that
the fit did not use, of the flat block nearest to half of full scale.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from calib.arrays import Columns, RawLines
from calib.radiometric.coefficients.coefficient_set import CoefficientSet
from calib.recording.block_statistics import BlockStatistics

HELD_OUT_EVERY = 8
"""One line of so many of a block has no part in the fit."""
LINES_AT_MOST = 2048
LINES_AT_ONCE = 8
"""What is worked out for so few lines stays in a core's cache."""


@dataclass(frozen=True)
class Uniformity:
    """Coefficients of variation along the valid columns, percent.

    Attributes:
        block: The block's name.
        n_lines: How many held-out lines there are.
        before: Of the mean line's DN / VE.
        after: Of the mean line's radiance.
        before_offset_removed: Of (DN − dark level) / VE: the responsivity's scatter alone.
        before_single_line: Median over single lines; None where no lines were looked at.
        after_single_line: As above.
    """

    block: str
    n_lines: int
    before: float
    after: float
    before_offset_removed: float
    before_single_line: float | None = None
    after_single_line: float | None = None


def nearest_to_half_scale(
    statistics: Sequence[BlockStatistics], full_scale_dn: int
) -> BlockStatistics | None:
    """Return the flat block whose median column is nearest to half of full scale."""
    flats = [s for s in statistics if s.block.kind == "flat" and s.n_lines > 0]
    if not flats:
        return None
    return min(flats, key=lambda s: abs(float(np.median(s.mean_dn)) - 0.5 * full_scale_dn))


def held_out_lines(stretches: Iterable[RawLines], every: int) -> Iterator[RawLines]:
    """Yield the lines that `column_statistics` holds out of a block: each `every`-th one.

    They are raw: a tone that is removed before averaging is still in them.
    """
    seen = 0
    for stretch in stretches:
        yield stretch[every - 1 - seen % every :: every]
        seen += len(stretch)


def uniformity(
    coefficients: CoefficientSet, held_out: BlockStatistics, lines: Iterable[RawLines] = ()
) -> Uniformity:
    """Judge a set on one block.

    Args:
        coefficients: The set.
        held_out: Statistics of lines that the fit did not use.
        lines: Those lines themselves, for the figures of single lines; stretches of them.
    """
    exposure = held_out.block.exposure_us
    mean_line = held_out.mean_dn[None, :]
    single: list[tuple[Columns, Columns]] = []
    seen = 0
    for stretch in lines:
        if seen >= LINES_AT_MOST:
            break
        for first in range(0, len(stretch), LINES_AT_ONCE):
            few = stretch[first : first + LINES_AT_ONCE]
            single.append(_before_and_after(coefficients, few, exposure))
        seen += len(stretch)
    raw, corrected = (
        (np.concatenate(v) for v in zip(*single, strict=True)) if seen else (None, None)
    )
    before, after = _before_and_after(coefficients, mean_line, exposure)
    above = mean_line - coefficients.dark_level_dn(exposure)
    cleaned = variation_percent((above / coefficients.vignette)[:, coefficients.valid])
    return Uniformity(
        block=held_out.block.block,
        n_lines=held_out.n_lines,
        before=float(before[0]),
        after=float(after[0]),
        before_offset_removed=float(cleaned[0]),
        before_single_line=None if raw is None else float(np.median(raw)),
        after_single_line=None if corrected is None else float(np.median(corrected)),
    )


def _before_and_after(
    coefficients: CoefficientSet, dn: RawLines | Columns, exposure_us: float
) -> tuple[Columns, Columns]:
    """Return, in percent and by line: of DN/VE, of radiance."""
    use = coefficients.valid
    codes = dn[:, use].astype(np.float64)
    above = codes - coefficients.dark_level_dn(exposure_us)[use]
    radiance = above * (1.0 / (coefficients.slope[use] * exposure_us))
    return variation_percent(codes * (1.0 / coefficients.vignette[use])), variation_percent(
        radiance
    )


def variation_percent(values: Columns) -> Columns:
    """Return 100·standard deviation / mean along the columns, (n_lines,)."""
    mean = values.mean(axis=1)
    away = values - mean[:, None]
    variance = np.einsum("ij,ij->i", away, away) / (values.shape[1] - 1)
    return np.asarray(100.0 * np.sqrt(variance) / mean)
