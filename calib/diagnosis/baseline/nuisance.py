"""What each pixel has a coefficient of its own for, beside which effects are looked for.

Of one recording: an offset and a slope. Where a scene's radiance is what it shows itself, each
pixel has a slope of the scene's own in its blocks: see `calib.diagnosis.baseline.scenes`. Where
hours part recordings, offsets and slopes of the later ones are their own: temperature, dust and a
lamp that was lit anew change them.
"""

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.recorded.conditions_table import ConditionsTable

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]


def regressors(table: ConditionsTable, shape: tuple[int, int]) -> tuple[Floats, ...]:
    """Return them, (n_blocks,) or `shape`, (n_blocks, n_pixels): common offset and slope first."""
    even = np.ones(shape[0])
    dose = table.dose_of((1, shape[1])).reshape(shape)
    found = [even, dose]
    for name in sorted(table.estimated):
        seen = np.array([block.scene == name for block in table.blocks])
        found.append(table.exposure_us * seen)
    for session in range(1, max(table.sessions, default=0) + 1):
        later = np.array([float(k == session) for k in table.sessions])
        found += [later, dose * later[:, None]]
    return tuple(found)


def scene_blocks(table: ConditionsTable) -> Flags:
    """Return which blocks, (n_blocks,), show a scene whose radiance is estimated."""
    return np.array([block.scene in table.estimated for block in table.blocks])
