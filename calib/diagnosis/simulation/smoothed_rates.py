"""Rates of rare events in a few drawn lines, the smoother the fewer events they are told by."""

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.recorded.conditions_table import ConditionsTable

Floats = NDArray[np.float64]

FEW_EVENTS = 10.0
"""So many in a block tell their rate as well as other blocks' do."""


def smoothed_rates(rates: Floats, trials: Floats, table: ConditionsTable) -> Floats:
    """Return rates of each block, drawn to what exposure and light make of those of all blocks.

    Args:
        rates: Events by trial, (n_blocks, n_rare).
        trials: In the lines that were drawn of a block, (n_rare,).
        table: The blocks' conditions.
    """
    if not rates.any():
        return rates
    smooth = _smoothing(table) @ rates
    events = np.abs(rates) * trials
    return np.asarray((events * rates + FEW_EVENTS * smooth) / (events + FEW_EVENTS))


def _smoothing(table: ConditionsTable) -> Floats:
    """Return what fits blocks' values by exposure and light, (n_blocks, n_blocks)."""
    light = table.dose / max(float(table.dose.max()), 1e-300)
    exposure = table.exposure_us / float(table.exposure_us.max())
    of_all = (np.ones_like(light), exposure, light, table.dark.astype(float))
    design = np.stack(of_all, axis=1)
    return np.asarray(design @ np.linalg.pinv(design))
