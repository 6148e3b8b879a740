"""What a monitor photodiode says of the light, beside the camera.

It looks at the source and not through the lens, and no gain of the camera's is in it: a lamp that
drifts moves both, a system gain that drifts moves the camera alone. Its own scale is known from
nowhere, and it need not be linear: what counts is how readings change among blocks of one level.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.random import default_rng
from numpy.typing import NDArray

from calib.arrays import Columns
from calib.diagnosis.recorded.conditions_table import ConditionsTable
from calib.forward.departure import Departure
from calib.forward.effect import Stage

UNKNOWN_STD = 2e-4
"""Relative, of a reading, where too few were made to tell it."""
LEAST_STD = 1e-4
"""Relative: what a photodiode's responsivity and its geometry keep over hours at best."""
FEWEST = 5
"""Readings that tell their own scatter."""
_UNUSED = default_rng(0)


@dataclass(frozen=True)
class MonitorReadings:
    """Readings of the blocks that are lit.

    Attributes:
        observed: Logarithm of each reading over the nominal radiance, (n_blocks,); 0 where unread.
        group: Which blocks share a level and a session, (n_blocks,); -1 where unread.
        started_s: When they began, (n_blocks,).
    """

    observed: Columns
    group: NDArray[np.intp]
    started_s: Columns

    @cached_property
    def std(self) -> float:
        """Standard deviation of an observed value: how each lies between its neighbours in time.

        A steady drift does not change that. Source: von Neumann et al., The mean square successive
        difference, Ann. Math. Stat. 12, 153 (1941), one order higher, for uneven times.
        """
        of_groups = [
            _between(self.observed[self.group == g], self.started_s[self.group == g])
            for g in range(int(self.group.max(initial=-1)) + 1)
        ]
        off = np.concatenate([np.zeros(0), *of_groups])
        if len(off) < FEWEST - 2:
            return UNKNOWN_STD
        return float(np.hypot(np.sqrt((off**2).mean()), LEAST_STD))

    def whitened(self, change: NDArray[np.float64]) -> Columns:
        """Return a change of the readings without each group's mean, over its std, (n_blocks,)."""
        values = np.broadcast_to(change, self.observed.shape).astype(np.float64)
        found = np.zeros(len(values))
        for g in range(int(self.group.max(initial=-1)) + 1):
            of_group = self.group == g
            found[of_group] = values[of_group] - values[of_group].mean()
        return np.asarray(found / self.std)


def readings_of(table: ConditionsTable) -> MonitorReadings:
    """Return what the monitor read in flats."""
    sessions = table.sessions or (0,) * len(table.blocks)
    groups: dict[tuple[int, float], int] = {}
    observed, group = np.zeros(len(sessions)), np.full(len(sessions), -1, np.intp)
    for b, (block, radiance) in enumerate(zip(table.blocks, table.radiance, strict=True)):
        if block.kind != "flat" or not block.monitor or block.monitor < 0 or radiance <= 0:
            continue
        group[b] = groups.setdefault((sessions[b], block.level), len(groups))
        observed[b] = np.log(block.monitor / radiance)
    return MonitorReadings(observed, group, table.started_s)


def _between(values: Columns, at_s: Columns) -> Columns:
    """Return what values miss the line between their neighbours by, of their own variance."""
    if len(values) < 3:
        return np.zeros(0)
    whole = at_s[2:] - at_s[:-2]
    share = np.where(whole > 0, (at_s[1:-1] - at_s[:-2]) / np.where(whole > 0, whole, 1.0), 0.5)
    off = values[1:-1] - (1.0 - share) * values[:-2] - share * values[2:]
    return np.asarray(off / np.sqrt(1.0 + (1.0 - share) ** 2 + share**2))


def light_change(effects: Sequence[Departure], table: ConditionsTable) -> Columns:
    """Return what effects of the source change in the logarithm of its light, (n_blocks,).

    Light that comes in beside the source is not seen at its monitor, nor what is faster than it.
    """
    of_source = [
        e
        for e in effects
        if e.stage == Stage.SOURCE and e.shows_in != "spectrum" and not e.adds_light
    ]
    found = np.zeros(len(table.blocks))
    if not of_source:
        return found
    for b, block in enumerate(table.blocks):
        if block.kind != "flat" or not block.monitor:
            continue
        # At its beginning and its end, as it is read.
        at = table.at(b, np.array([0.0, table.n_lines[b]]))
        light: NDArray[np.float64] = np.ones((2, 1))
        for effect in of_source:
            light = np.asarray(effect.apply(light, at, _UNUSED), np.float64)
        found[b] = float(np.log(np.maximum(light.mean(), 1e-9)))
    return found
