"""A block in a few numbers: mean, temporal and spatial variance, and how sure each is."""

import math
from dataclasses import dataclass

import numpy as np
from scipy.stats import chi2

from calib.recording.header import Block
from calib.recording.statistics_csv import StatisticsRow
from calib.transfer.emva1288.block_image import BlockImage

CHANCE = 1e-4
"""Below this probability a spread is not put down to noise."""


@dataclass(frozen=True)
class BlockFigures:
    """What the standard's curves are made of; DN and DN².

    Attributes:
        block: The conditions.
        n_frames: Of the block; 2 where only sums survive, which is the standard's number.
        mean_dn: µ_y, Eq. 16.
        mean_dn_std: Its standard uncertainty.
        variance_dn2: σ²_y, Eq. 18.
        variance_dn2_std: Its standard uncertainty.
        within_dn2: The temporal variance about each frame's own mean.
        spatial_dn2: s²_y of the image as it is, not below 0; NaN where only sums survive.
        share_at_full_scale: Share of the samples at the highest code; NaN where unknown.
        share_at_zero: The same at code 0.
    """

    block: Block
    n_frames: int
    mean_dn: float
    mean_dn_std: float
    variance_dn2: float
    variance_dn2_std: float
    within_dn2: float
    spatial_dn2: float
    share_at_full_scale: float
    share_at_zero: float


def figures_of(image: BlockImage) -> BlockFigures:
    r"""Reduce a block of L frames of N × M pixels to its figures.

    An area sensor's temporal variance is Eq. 18 averaged over all pairs of frames,
    σ² = (mean of the pixels' variances − variance of the frames' means) · NM/(NM − 1):
    what moves a whole frame is the light's doing and is taken off. A line sensor's frame is one
    line; a line's common motion is the camera's own noise and stays.

    Its variance: 2/(L+1) Σ s_i⁴/(NM)², unbiased for normal noise whatever each pixel's size, and
    2/(L−1) (V² − (σ²/N)²)/M for rows that move together, V being the variance of a row's mean.
    (Poisson's excess kurtosis adds one part in 2 µ_e, which is left out.)
    """
    n, (rows, columns) = image.n_frames, image.mean_dn.shape
    pixels = rows * columns
    total, common = float(np.mean(image.variance_dn2)), image.frame_variance_dn2
    within = (total - common) * pixels / max(1, pixels - 1)
    is_line = rows == 1
    moving = image.row_variance_dn2 - (0.0 if is_line else common)
    squared = 2.0 / (n + 1) * float(np.mean(image.variance_dn2**2)) / pixels
    if n > 1:
        squared += 2.0 / (n - 1) * max(0.0, moving**2 - (within / columns) ** 2) / rows
    spatial = float(np.var(image.mean_dn)) - within / n
    return BlockFigures(
        block=image.block,
        n_frames=n,
        mean_dn=float(np.mean(image.mean_dn)),
        mean_dn_std=_mean_std(within / pixels, moving / rows, common, n, rows),
        variance_dn2=total if is_line else within,
        variance_dn2_std=math.sqrt(squared),
        within_dn2=within,
        spatial_dn2=max(0.0, spatial),
        share_at_full_scale=image.share_at_full_scale,
        share_at_zero=image.share_at_zero,
    )


def _mean_std(white: float, by_rows: float, by_frames: float, n: int, rows: int) -> float:
    """Return the mean's standard uncertainty: from noise, or from what rows or frames move by.

    The rows' and the frames' own means are believed where they spread more than noise explains:
    a few of them tell too little of their spread to be believed always.
    """
    if n < 2:
        return math.nan
    found = white
    for seen, free in ((by_rows, rows * (n - 1)), (by_frames, n - 1)):
        found = seen if seen > found * float(chi2.isf(CHANCE, free)) / free else found
    return math.sqrt(max(0.0, found) / n)


def figures_of_sums(block: Block, row: StatisticsRow) -> BlockFigures:
    """Return what the sums of a block without frames say; the standard's two frames assumed."""
    variance = math.nan if row.variance_dn2 is None else row.variance_dn2
    return BlockFigures(
        block=block,
        n_frames=2,
        mean_dn=row.mean_dn,
        mean_dn_std=math.sqrt(variance / row.samples),
        variance_dn2=variance,
        variance_dn2_std=variance * math.sqrt(4.0 / row.samples),
        within_dn2=variance,
        spatial_dn2=math.nan,
        share_at_full_scale=math.nan,
        share_at_zero=math.nan,
    )
