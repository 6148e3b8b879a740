"""What noise that all columns of a line share leaves unsure in system gain and read noise.

The recording has one sample of it, from as many lines as a block has, and the correction its
expectation: variances of a block are off together, with a standard deviation of sqrt(2 / (n - 1))
of the shared variance. Photon transfer takes columns for independent and cannot know.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.random import default_rng

from calib.arrays import Columns
from calib.errors import NotDeterminedError
from calib.recording.block_statistics import BlockStatistics
from calib.recording.header import CameraHeader
from calib.transfer.photon_transfer.measure import gain_and_noise

DRAWS = 12
NEGLIGIBLE_SHARE = 1e-3
"""Of a variance; below it, nothing is added."""


@dataclass(frozen=True)
class SharedNoise:
    """Standard uncertainties that come on top: of the system gain, and of the read noise in e-."""

    system_gain_dn_per_e: float
    read_noise_e: float


def shared_noise(
    fit: Sequence[BlockStatistics], share: Columns, camera: CameraHeader
) -> SharedNoise:
    """Return what shared noise adds, by photon transfer of variances that it has moved.

    Args:
        fit: Statistics without departures.
        share: Of each block's variance as recorded that all columns of a line have in common,
            (n_blocks,).
        camera: The recording's.
    """
    lines = np.array([s.n_lines for s in fit], np.float64)
    relative = share * np.sqrt(2.0 / np.maximum(lines - 1.0, 1.0))
    if not (share > NEGLIGIBLE_SHARE).any():
        return SharedNoise(0.0, 0.0)
    rng, found = default_rng(0), []  # the same recording gives the same set
    for _ in range(DRAWS):
        factor = np.maximum(1.0 + relative * rng.standard_normal(len(fit)), 0.0)
        moved = [
            replace(s, variance_dn2=s.variance_dn2 * f) for s, f in zip(fit, factor, strict=True)
        ]
        try:
            measured = gain_and_noise(moved, camera)
        except NotDeterminedError:
            continue
        found.append((measured.system_gain.value, measured.read_noise_e.value))
    known = np.array([each for each in found if np.isfinite(each).all()])
    if len(known) < 2:
        return SharedNoise(0.0, 0.0)
    gain, read = known.std(axis=0, ddof=1)
    return SharedNoise(float(gain), float(read))
