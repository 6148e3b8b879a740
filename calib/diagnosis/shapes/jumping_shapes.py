"""Shapes of pixels that jump, as the recording tells them: how many, and how high."""

from math import log

import numpy as np

from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.evidence.jumping import jumping_pixels
from calib.diagnosis.evidence.standing_out import steps
from calib.diagnosis.shapes.far_claims import EVERY_NOISE
from calib.diagnosis.shapes.shape import Shape
from calib.diagnosis.statistics.rare import SINGLE
from calib.forward.effects.rts_pixels import RtsPixels

DWELLS = (3.0, 12.0, 50.0, 1000.0)
"""Lines for which pixels stay in a level, that are tried."""


def jumping_shapes(evidence: Evidence) -> tuple[Shape, ...]:
    """Return jumps of as many pixels as jump, as high as these scatter.

    Each pixel's added variance explains a deviance, and pays for itself and for its place. What the
    counts of pixels show of that as recorded, they are credited with already; the rest is a credit.
    """
    jumping = jumping_pixels(evidence)
    n = len(jumping.pixels)
    if n == 0:
        return ()
    period_s, share = evidence.table.line_period_us * 1e-6, n / evidence.sensor.n_pixels
    price = n * (1.0 + 2.0 * log(evidence.sensor.n_pixels))
    credit = max(float(jumping.deviance.sum()) - price - _counted(evidence), 0.0)
    return tuple(
        Shape(
            RtsPixels(jumping.amplitude_dn, share, lines * period_s, lines * period_s),
            (),
            two_sided=False,
            freedom=1.0 - credit / 2.0,
        )
        for lines in DWELLS
    )


def _counted(evidence: Evidence) -> float:
    """Return the deviance of counts: of pixels by variances, by means' misfits, of noisy ones."""
    seen = evidence.observed()
    scatter = seen.pixel_variance * np.sqrt((evidence.n - 1).sum() / 2.0)
    often = evidence.rare_space.whitened(evidence.rare_space.seen)[len(SINGLE) * EVERY_NOISE]
    counts = (*steps(scatter), *steps(seen.pixel_misfit), often)
    return float(np.square(counts).sum())
