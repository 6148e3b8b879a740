"""The smooth error of the code that a converter's nonlinearity is, told by the residual means.

Sines of the code are fitted, no more of them than pay for themselves: of many that say little, no
turn of the curve is sure. What bends one way only, as a response that saturates does, is the
signal's, and no shape of a converter is made of it.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.shapes.shape import Shape
from calib.forward.effects.adc_inl import AdcInl

Floats = NDArray[np.float64]

FEWEST, MOST = 4, 12
"""Sines of a converter's nonlinearity."""
PRICE = 4.0
"""Deviance that one more of them has to explain: two standard deviations, squared."""
TURNS = 2
"""A smooth error of the code turns so often at least, beside a straight line."""
CLEAR_SIGMA = 3.0
"""Between two turns it moves by so much at least."""


@dataclass(frozen=True)
class _Curve:
    """The first sines' heights, DN, (n,), their covariance, and the deviance they explain."""

    heights: Floats
    covariance: Floats
    gain: float


def turning_shapes(evidence: Evidence) -> tuple[Shape, ...]:
    """Return the sum of sines of the code that the residual means follow, where it turns."""
    top = evidence.sensor.camera.full_scale_dn
    x = np.pi * np.clip(evidence.baseline.mean_dn.reshape(evidence.n_blocks, -1) / top, 0.0, 1.0)
    curve = _fitted(x, evidence)
    used = evidence.space.weight > 0
    if not used.any() or _turns(curve, x[used]) < TURNS:
        return ()
    bow, s, w, *higher = (float(h) for h in curve.heights)
    template = AdcInl(bow, s, w, tuple(higher), bit_depth=evidence.sensor.camera.bit_depth)
    varied = (
        ("bow_dn", bow, 0.0), ("s_dn", s, 0.0), ("w_dn", w, 0.0), ("higher_dn", tuple(higher), 0.0),
    )  # fmt: skip
    return (Shape(template, varied, two_sided=True, freedom=float(len(curve.heights))),)


def _fitted(x: Floats, evidence: Evidence) -> _Curve:
    """Return as many sines of x, pi DN / full scale, (n_blocks, n_pixels), as are worth it."""
    space = evidence.space
    residual = space.project(evidence.observed().means)
    sines = [space.project(np.sin(k * x)) for k in range(1, MOST + 1)]
    gram = np.array([[space.product(a, b) for b in sines] for a in sines])
    along = np.array([space.product(a, residual) for a in sines])
    scale = 1.0 / np.sqrt(np.maximum(np.diag(gram), 1e-12))
    curves = [_of_first(n, gram, along, np.outer(scale, scale)) for n in range(FEWEST, MOST + 1)]
    return max(curves, key=lambda each: each.gain - PRICE * len(each.heights))


def _of_first(n: int, gram: Floats, along: Floats, scale: Floats) -> _Curve:
    first = (slice(n), slice(n))
    scaled = gram[first] * scale[first]
    covariance = np.linalg.pinv(scaled, rcond=1e-4) * scale[first]
    heights = covariance @ along[:n]
    gain = float(2.0 * along[:n] @ heights - heights @ gram[first] @ heights)
    return _Curve(heights, covariance, gain)


def _turns(curve: _Curve, x: Floats) -> int:
    """Return how often the sum of sines turns over the codes x, pi DN / full scale, for sure."""
    k = np.arange(1, len(curve.heights) + 1)
    grid = np.unique(np.quantile(x, np.linspace(0.0, 1.0, 48)))
    line = np.stack([np.ones_like(grid), grid], axis=1)
    # What is straight in the code is offset and slope.
    off_line = np.eye(len(grid)) - line @ np.linalg.pinv(line)
    basis = off_line @ np.sin(np.outer(grid, k))
    y, spread = basis @ curve.heights, basis @ curve.covariance @ basis.T
    turns, extreme, way = 0, 0, 0
    for j in range(1, len(grid)):
        move = y[j] - y[extreme]
        std = np.sqrt(
            max(spread[j, j] + spread[extreme, extreme] - 2.0 * spread[j, extreme], 1e-18)
        )
        if way * move > 0:
            extreme = j
        elif abs(move) > CLEAR_SIGMA * std:
            turns, extreme, way = turns + (way != 0), j, int(np.sign(move))
    return turns
