"""Which tap's converter is at fault where bits stick: that in which nearly all of them flip."""

import numpy as np

from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.statistics.rare import FLIPS, RARE

MOSTLY = 0.9
"""Of the flips that are seen, in one tap: what else stands out may look like one."""
FEWEST = 16
"""Flips: by chance so many lie in one of two taps in one recording of 30,000."""


def faulty_tap(bit: int, value: int, evidence: Evidence) -> int | None:
    """Return the tap in which nearly all samples lie whose `bit` was set to `value`, if any."""
    sensor = evidence.sensor
    if sensor.n_taps == 1:
        return None
    kind = RARE.index("raised_0") + bit + (0 if value else FLIPS)
    flipped = [each.events.pixel[each.events.kind == kind] for each in evidence.sums]
    by_tap = np.bincount(sensor.tap.ravel()[np.concatenate(flipped)], minlength=sensor.n_taps)
    most = int(np.argmax(by_tap))
    enough = by_tap.sum() >= FEWEST and by_tap[most] >= MOSTLY * by_tap.sum()
    return most if enough else None
