"""Where the fit of columns and levels starts, and whether it can."""

import numpy as np

from calib.arrays import Columns
from calib.errors import NotDeterminedError
from calib.kernels.column_fit import fit_lines
from calib.radiometric.estimation.block_table import BlockTable, Mask
from calib.radiometric.estimation.radiance_table import LevelGroups


def first_levels(flats: BlockTable, groups: LevelGroups, use: Mask) -> Columns:
    """Return a first guess of each group's relative level; 1 for the reference.

    The reference is the level with most distinct exposures that are not clipped everywhere, and
    among equals the one with most unclipped cells. DN0 and slope of the guess are its own.

    Raises:
        NotDeterminedError: `one-exposure` or `all-saturated`.
    """
    score = []
    for g in range(len(groups.level)):
        rows = (groups.of_block == g) & (use.sum(axis=1) > 0)
        score.append((len(np.unique(flats.exposure_us[rows])), int(use[rows].sum())))
    reference = max(range(len(score)), key=lambda g: score[g])
    if score[reference][0] < 2:
        raise _no_sweep(flats, groups)
    rows = groups.of_block == reference
    lines = fit_lines(flats.mean_dn[rows], use[rows] * 1.0, flats.light_us[rows])
    expected = np.outer(flats.light_us, lines.slope)
    above = flats.mean_dn - lines.offset
    seen = use & np.isfinite(expected) & (expected > 0)
    n_groups = len(groups.level)
    per_block = (np.where(seen, each, 0.0).sum(axis=1) for each in (above, expected))
    seen_dn, expected_dn = (np.bincount(groups.of_block, each, n_groups) for each in per_block)
    start = np.full(n_groups, np.nan)
    np.divide(seen_dn, expected_dn, out=start, where=(expected_dn > 0) & (seen_dn > 0))
    start[reference] = 1.0
    return start


def first_weights(flats: BlockTable, use: Mask) -> Columns:
    """Return what a mean of each block is worth, (n_blocks,): lines over the pooled variance."""
    seen = use & (flats.variance_dn2 > 0)
    pooled = np.where(seen, flats.variance_dn2, 0.0).sum(axis=1) / np.maximum(seen.sum(axis=1), 1)
    usual = pooled[pooled > 0].mean() if pooled.any() else 1.0
    return np.asarray(flats.n_lines / np.where(pooled > 0, pooled, usual))


def _no_sweep(flats: BlockTable, groups: LevelGroups) -> NotDeterminedError:
    """Say why no level has two exposures that can be used."""
    several = any(
        len(np.unique(flats.exposure_us[groups.of_block == g])) > 1
        for g in range(len(groups.level))
    )
    if several:
        return NotDeterminedError(
            "The flats are clipped at nearly every exposure, so that no line can be laid through "
            "them: record with less light or shorter exposures.",
            code="all-saturated",
        )
    return NotDeterminedError(
        "No level was recorded at two exposures or more, so that offset and responsivity cannot "
        "be told apart: record flats of one level at several exposures.",
        code="one-exposure",
    )
