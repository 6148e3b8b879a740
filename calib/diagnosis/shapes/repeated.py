"""Lines that come twice, code for code: how certain it is that no chance made them."""

from math import log, pi, sqrt

import numpy as np

from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.evidence.rare_space import whitened_counts
from calib.diagnosis.shapes.shape import Shape
from calib.diagnosis.statistics.rare import RARE
from calib.diagnosis.statistics.repeats import UNLIKELY
from calib.forward.effects.duplicated_lines import DuplicatedLines

PART = 0.5
"""Half a line that comes again is counted, too: the other half's codes are no proof."""


def repeated_shapes(evidence: Evidence) -> tuple[Shape, ...]:
    """Return repeated lines: that one of them is chance is less likely than its count tells.

    Of n events where m are expected by chance the deviance is 2 (n ln(n / m) - n + m); the scale on
    which counts scatter by 1 has less of it, and the rest is a credit.
    """
    counts = np.array([each.rare[RARE.index("identical_lines")] for each in evidence.sums])
    deviance = sum(
        2.0 * n * (log(n) - log_chance(evidence, b) - 1.0) for b, n in enumerate(counts) if n > 0
    )
    seen = float(whitened_counts(np.array(counts.sum()))) ** 2
    unit = DuplicatedLines().probability
    varied = (("probability", unit, 0.0),)
    credit = max(deviance - seen, 0.0)
    return (Shape(DuplicatedLines(unit), varied, two_sided=False, freedom=-credit / 2.0),)


def log_chance(evidence: Evidence, block: int) -> float:
    """Return ln of how many lines of a block repeat the one before by chance.

    Two samples of a pixel differ by a normal deviate of sqrt(2) times its noise s, whose density
    is 1 / (2 s sqrt(pi)) at most: so likely is it that they share a code, one DN wide. No more than
    `UNLIKELY` of the block's lines do, or none would have been counted.
    """
    variance = evidence.baseline.variance_dn2[block] - 1.0 / 12.0
    alike = 1.0 / (2.0 * np.sqrt(np.maximum(variance, 1e-12)) * sqrt(pi))
    nats = -float(np.log(np.minimum(alike, 1.0)).sum())
    return min(log(float(evidence.n[block])) - PART * nats, log(UNLIKELY))
