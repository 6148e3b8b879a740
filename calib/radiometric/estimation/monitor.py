"""The monitor photodiode: does it follow the source's changes within a level, and do they count?

A block of the level g that the monitor read m_b in had the light r_g·m_b/m̄_g, with m̄_g the mean
reading of the level's blocks: the certified radiance is that of a level as a whole, which n_g
blocks tell to ω/√n_g, ω being the relative scatter of the readings within levels. Readings of
different levels are not compared: a monitor sees other lamps from elsewhere. Whether the
monitor sees what the camera sees is asked of the blocks' residuals e_b, averaged over columns,
with the signal S_b and δ_b = m_b/m̄_g − 1:

    e_b = β·δ_b·S_b + (what offset, slope and levels can absorb) + noise

by least squares, weighted by what `common_mode` says of the noise. A monitor that follows has
β = 1, one that does not has 0. It is used where β is above 1/2, from where on dividing by it
lowers the residuals, and above 0 beyond chance (Student's t, one in a thousand). What the monitor
gets wrong then stands in the residuals like an unrest of the source, and is counted as one.
"""

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from scipy.stats import t as student

from calib.arrays import Columns
from calib.radiometric.estimation.block_table import BlockTable
from calib.radiometric.estimation.common_mode import CommonMode, block_design, mean_residual
from calib.radiometric.estimation.joint_fit import JointFit
from calib.radiometric.estimation.radiance_table import LevelGroups

BY_CHANCE = 1e-3
LEAST_SHARE = 0.5

Verdict = Literal["used", "ignored", "none", "not testable", "not followed"]


@dataclass(frozen=True)
class MonitorCheck:
    """What became of the monitor's readings.

    Attributes:
        verdict: "none" where a flat has no reading; "not testable" without degrees of freedom.
        share: β; NaN where not asked for.
        share_std: Its standard uncertainty.
        wander: ω, relative; NaN where no level has two blocks.
    """

    verdict: Verdict
    share: float = float("nan")
    share_std: float = float("nan")
    wander: float = float("nan")

    @property
    def used(self) -> bool:
        """True where the blocks' light was corrected."""
        return self.verdict == "used"


def relative_light(flats: BlockTable, groups: LevelGroups) -> Columns | None:
    """Return m_b/m̄_g, (n_blocks,); None unless every flat has a positive reading."""
    readings = np.array([b.monitor if b.monitor is not None else np.nan for b in flats.blocks])
    if not (readings > 0).all():
        return None
    mean = np.bincount(groups.of_block, readings) / np.bincount(groups.of_block)
    return np.asarray(readings / mean[groups.of_block])


def check_monitor(
    light: Columns | None, groups: LevelGroups, fit: JointFit, shared: CommonMode
) -> MonitorCheck:
    """Ask the residuals of a fit without the monitor whether it follows the source."""
    if light is None:
        return MonitorCheck("none")
    repeats = len(light) - len(np.unique(groups.of_block))
    wander = float(np.sqrt(((light - 1.0) ** 2).sum() / repeats)) if repeats else float("nan")
    blocks = block_design(fit, groups.of_block)
    used, signal = blocks.used, shared.mean_slope * fit.x_us[blocks.used]
    rows = np.column_stack([(light[used] - 1.0) * signal, blocks.design])
    freedom = len(rows) - rows.shape[1]
    if freedom < 1 or not wander > 0 or not np.isfinite(shared.source_unrest):
        return MonitorCheck("not testable", wander=wander)
    noise2 = shared.block_variance_dn2 + (shared.source_unrest * signal) ** 2
    rows = rows / np.sqrt(noise2)[:, None]
    found, _, rank, _ = np.linalg.lstsq(
        rows, mean_residual(fit, shared.mean_slope)[used] / np.sqrt(noise2), rcond=None
    )
    if rank < rows.shape[1]:
        return MonitorCheck("not testable", wander=wander)
    rest = mean_residual(fit, shared.mean_slope)[used] / np.sqrt(noise2) - rows @ found
    std = float(np.sqrt(np.linalg.inv(rows.T @ rows)[0, 0] * (rest @ rest) / freedom))
    share = float(found[0])
    follows = share > LEAST_SHARE and float(student.sf(share / std, freedom)) < BY_CHANCE
    return MonitorCheck("used" if follows else "not followed", share, std, wander)


def level_unrest(monitor: MonitorCheck, groups: LevelGroups) -> Columns:
    """Return ω/√n_g, (n_groups,); 0 where the monitor is not used: blocks then have the unrest."""
    n_blocks = np.bincount(groups.of_block, minlength=len(groups.level))
    return np.asarray((monitor.wander if monitor.used else 0.0) / np.sqrt(n_blocks))


def with_light(flats: BlockTable, light: Columns) -> BlockTable:
    """Return the flats with their exposures weighed by what the monitor saw."""
    return replace(flats, light_us=flats.exposure_us * light)
