"""Shapes of pixels that jump, as the recording tells them: how many, and how high."""

from math import log

import numpy as np

from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.evidence.jumping import jumping_pixels
from calib.diagnosis.evidence.rare_space import whitened_counts
from calib.diagnosis.shapes.shape import Shape
from calib.forward.effects.rts_pixels import RtsPixels

DWELLS = (3.0, 12.0, 50.0, 1000.0)
"""Lines for which pixels stay in a level, that are tried."""
COUNTED = 3.0
"""So many counts have what jumps: of variances, of means' misfits, of pixels that often stand
out."""


def jumping_shapes(evidence: Evidence) -> tuple[Shape, ...]:
    """Return jumps of as many pixels as jump, as high as these scatter.

    Each pixel's added variance explains a deviance, and pays for itself and for its place; counts
    of pixels have less of that, and the rest is a credit.
    """
    jumping = jumping_pixels(evidence)
    n = len(jumping.pixels)
    if n == 0:
        return ()
    period_s, share = evidence.table.line_period_us * 1e-6, n / evidence.sensor.n_pixels
    price = n * (1.0 + 2.0 * log(evidence.sensor.n_pixels))
    counted = COUNTED * float(whitened_counts(np.array(float(n)))) ** 2
    credit = max(float(jumping.deviance.sum()) - price - counted, 0.0)
    return tuple(
        Shape(
            RtsPixels(jumping.amplitude_dn, share, lines * period_s, lines * period_s),
            (),
            two_sided=False,
            freedom=1.0 - credit / 2.0,
        )
        for lines in DWELLS
    )
