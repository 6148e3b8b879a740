"""Orthogonal parts of whitened statistics."""

from collections.abc import Sequence

import numpy as np

from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.evidence.point import Point


def orthonormal(directions: Sequence[Point], evidence: Evidence) -> list[Point]:
    """Return an orthonormal basis of `directions`."""
    basis: list[Point] = []
    for each in directions:
        rest = without(each, basis, evidence)
        length2 = evidence.product(rest, rest)
        if length2 > 1e-8 * max(evidence.product(each, each), 1e-300):
            basis.append(rest * (1.0 / np.sqrt(length2)))
    return basis


def without(point: Point, basis: Sequence[Point], evidence: Evidence) -> Point:
    """Return the part of `point` that is orthogonal to `basis`."""
    for each in basis:
        point = point - each * evidence.product(each, point)
    return point
