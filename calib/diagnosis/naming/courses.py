"""Fits effects whose law is left free: which of the functions that are open, and how much of each.

A drift that comes and goes, or steps, is still one of lamp, gain or offset: what it does to pixels,
and to their noise, tells which. Beside the shape of the catalogue that fits best, functions that
`laws` yields are added one by one, each while it is worth its price.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.evidence.point import Point
from calib.diagnosis.evidence.projection import orthonormal, without
from calib.diagnosis.naming.laws import Laws, laws, leaves_parameters
from calib.diagnosis.naming.model import Member
from calib.diagnosis.signatures.signature import Signature
from calib.diagnosis.simulation.sampled_lines import is_tone
from calib.diagnosis.statistics.change import Change

Floats = NDArray[np.float64]

PRICE = 12.0
"""Deviance of each function: 2 ln(W / (s sqrt(2 pi))) = 6 of its coefficient, s a fiftieth of the
range W, and 2 ln(20) = 6 of the choice among some twenty."""
NEW = 1e-3
"""Of a function's squared length, that those before it do not have."""


def course(
    signature: Signature, residual: Point, beside: Sequence[Point], evidence: Evidence
) -> tuple[tuple[Change, Point], ...]:
    """Return changes, and their points, that free an effect's law.

    They are those that explain most of `residual`, and orthogonal to the signature itself, whose
    strength stays what it is; not so where parameters keep their meaning, of which each is that of
    what the law leaves to it: of covariances, not of profiles that go their own way.

    Args:
        signature: Of the shape that fits best.
        residual: What is to be explained, the signature's part with it.
        beside: Orthonormal directions in which other effects can adapt.
        evidence: The recording.
    """
    own = _without_peaks(signature, evidence)
    adapting = [*beside, *orthonormal([without(own[1], beside, evidence)], evidence)]
    open_to = laws(signature, evidence)
    points = [evidence.point(each) for each in open_to.parts]
    rests = [without(point, adapting, evidence) for point in points]
    taken = chosen(
        open_to,
        _gram(points, evidence),
        _gram(rests, evidence),
        np.array([evidence.product(each, residual) for each in rests]),
    )
    first = [] if leaves_parameters(signature) else [own]
    found = list(first)
    for much in taken:
        change, point = signature.change * 0.0, signature.point * 0.0
        for share, part, direction in zip(much, open_to.parts, points, strict=True):
            change, point = change + part * float(share), point + direction * float(share)
        found += _rest(change, point, found, evidence)
    return tuple(found[len(first) :])


def _without_peaks(signature: Signature, evidence: Evidence) -> tuple[Change, Point]:
    """Return the normalised signature without what it does at peaks of the spectrum.

    They were chosen for their height, and no law is told by them (see `derivatives`).
    """
    change, point, length = signature.change, signature.point, signature.length
    if change.tones.any() and not is_tone(signature.shape.template):
        change = replace(change, tones=np.zeros_like(change.tones))
        point = evidence.point(change)
        length = float(np.sqrt(max(evidence.product(point, point), 1e-300)))
    return _normal(change, point, length)


def _gram(points: Sequence[Point], evidence: Evidence) -> Floats:
    return np.array([[evidence.product(a, b) for b in points] for a in points])


def chosen(open_to: Laws, whole: Floats, rest: Floats, along: Floats) -> list[Floats]:
    """Return the functions, (n_parts,) each, that are worth their price, the best first.

    Args:
        open_to: What may be chosen.
        whole: Inner products of the parts, (n_parts, n_parts).
        rest: The same without what others can adapt to.
        along: The parts' products with what is to be explained, (n_parts,).
    """
    functions, most = open_to.functions, open_to.most
    lengths2 = np.einsum("fi,ij,fj->f", functions, whole, functions)
    left, found = functions.copy(), []
    for _ in range(most):
        news = np.einsum("fi,ij,fj->f", left, rest, left)
        fine = news > NEW * np.maximum(lengths2, 1e-300)
        gains = np.where(fine, (left @ along) ** 2 / np.where(fine, news, 1.0), 0.0)
        if gains.max(initial=0.0) <= PRICE:
            break
        best = int(np.argmax(gains))
        one = left[best] / np.sqrt(news[best])
        found.append(functions[best])
        left = left - np.outer(left @ rest @ one, one)
    return found


def _rest(
    change: Change, point: Point, found: Sequence[tuple[Change, Point]], evidence: Evidence
) -> list[tuple[Change, Point]]:
    """Return the normalised part of a change that is new beside what was found; [] if none is."""
    for other, direction in found:
        along = evidence.product(direction, point)
        change, point = change - other * along, point - direction * along
    left = evidence.product(point, point)
    return [_normal(change, point, float(np.sqrt(left)))] if left > 0 else []


def _normal(change: Change, point: Point, length: float) -> tuple[Change, Point]:
    return change * (1.0 / length), point * (1.0 / length)


def with_courses(
    members: Sequence[Member], residual: Point, evidence: Evidence
) -> tuple[Member, ...]:
    """Return the members with their free laws fitted to what their shapes leave."""
    parts = [point for m in members for _, point in m.course]
    if not parts:
        return tuple(members)
    gram = np.array([[evidence.product(a, b) for b in parts] for a in parts])
    along = np.array([evidence.product(each, residual) for each in parts])
    much = iter((np.linalg.pinv(gram, rcond=1e-9) @ along).tolist())
    return tuple(replace(m, course_fit=tuple(next(much) for _ in m.course)) for m in members)


def freed(members: Sequence[Member], like: Change) -> Change:
    """Return what free laws change beyond the shapes."""
    total = like * 0.0
    for member in members:
        for (change, _), much in zip(member.course, member.course_fit, strict=True):
            total = total + change * much
    return total
