"""Courses in time that no shape of a drift has: each block's part of it, times a smooth function.

A drift that comes and goes, or steps, is still one of lamp, gain or offset: what it does to pixels,
and to their noise, tells which. Beside the shape of the catalogue that fits best, its course over
wall time is left free up to a polynomial and a step, whose coefficients are fitted and have their
price.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.polynomial.legendre import legvander

from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.evidence.point import Point
from calib.diagnosis.naming.model import Member
from calib.diagnosis.naming.signatures import Signature
from calib.diagnosis.statistics.change import Change

DEGREE = 5
"""Of the polynomial: it comes and goes twice."""
PRICE = 6.0
"""Deviance of each coefficient: 2 ln(W / (s sqrt(2 pi))), s a fiftieth of the range W."""
NEW = 1e-3
"""Of a part's squared length, that the parts before it do not have."""


def is_free(signature: Signature) -> bool:
    """Return whether an effect has a course in time that may be another one."""
    effect = signature.shape.template
    return signature.shape.two_sided and effect.shows_in == "mean" and "time" in effect.depends_on


def course(
    signature: Signature, residual: Point, evidence: Evidence
) -> tuple[tuple[Change, Point], ...]:
    """Return changes, and their orthonormal points, that free an effect's course.

    They are orthogonal to the signature itself, whose strength stays what it is. The last is the
    step that explains most of `residual`.
    """
    time = evidence.table.mid_s - evidence.table.mid_s.min()
    powers = legvander(2.0 * time / max(float(time.max()), 1e-300) - 1.0, DEGREE)[:, 1:]
    one = _normal(signature.change, signature.point, signature.length)
    found: list[tuple[Change, Point]] = [one]
    for power in powers.T:
        found += _rest(_scaled(signature.change, power), found, evidence)
    steps = (np.where(time > when, 1.0, -1.0) for when in np.sort(time)[:-1])
    rests = [_rest(_scaled(signature.change, step), found, evidence) for step in steps]
    news = [rest[0] for rest in rests if rest]
    if news:
        found.append(max(news, key=lambda new: abs(evidence.product(new[1], residual))))
    return tuple(found[1:])


def _rest(
    change: Change, found: Sequence[tuple[Change, Point]], evidence: Evidence
) -> list[tuple[Change, Point]]:
    """Return the normalised part of a change that is new beside what was found; [] if none is."""
    point = evidence.point(change)
    length2 = evidence.product(point, point)
    for other, direction in found:
        along = evidence.product(direction, point)
        change, point = change - other * along, point - direction * along
    left = evidence.product(point, point)
    fine = left > NEW * max(length2, 1e-300)
    return [_normal(change, point, float(np.sqrt(left)))] if fine else []


def _normal(change: Change, point: Point, length: float) -> tuple[Change, Point]:
    return change * (1.0 / length), point * (1.0 / length)


def with_courses(
    members: Sequence[Member], residual: Point, evidence: Evidence
) -> tuple[Member, ...]:
    """Return the members with their free courses fitted to what their shapes leave."""
    parts = [point for m in members for _, point in m.course]
    if not parts:
        return tuple(members)
    gram = np.array([[evidence.product(a, b) for b in parts] for a in parts])
    along = np.array([evidence.product(each, residual) for each in parts])
    much = iter((np.linalg.pinv(gram, rcond=1e-9) @ along).tolist())
    return tuple(replace(m, course_fit=tuple(next(much) for _ in m.course)) for m in members)


def freed(members: Sequence[Member], like: Change) -> Change:
    """Return what free courses change beyond the shapes."""
    total = like * 0.0
    for member in members:
        for (change, _), much in zip(member.course, member.course_fit, strict=True):
            total = total + change * much
    return total


def _scaled(change: Change, by_block: np.ndarray[tuple[int], np.dtype[np.float64]]) -> Change:
    """Return the change of means and pooled statistics, each block's times a factor."""
    nothing = change * 0.0
    return replace(
        nothing,
        means=change.means * by_block[:, None],
        pooled=change.pooled * by_block[:, None],
        monitor=change.monitor * by_block,
    )
