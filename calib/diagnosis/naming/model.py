"""The effects that were found, and what remains of a recording after them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from calib.diagnosis.baseline.baseline import Baseline
from calib.diagnosis.evidence.point import Point
from calib.diagnosis.signatures.signature import Signature
from calib.diagnosis.statistics.change import Change
from calib.forward.departure import Departure


@dataclass(frozen=True)
class Member:
    """An effect of the model with its fitted parameters.

    Attributes:
        signature: The shape and where its signature was taken.
        strength: As fitted.
        inner: Other parameters that the data determine, as fitted.
        std: Standard uncertainties: of the strength, and of the logarithms of the others.
        changes: Derivatives of the statistics, likewise.
        directions: The same, whitened.
        course: Changes, and their points, that free its course in time; none where it is a shape's.
        course_fit: How much of each.
    """

    signature: Signature
    strength: float
    inner: dict[str, float]
    std: tuple[float, ...]
    changes: tuple[Change, ...]
    directions: tuple[Point, ...]
    course: tuple[tuple[Change, Point], ...] = ()
    course_fit: tuple[float, ...] = ()

    @property
    def effect(self) -> Departure:
        """The effect as fitted."""
        return self.signature.shape.at(self.strength, self.inner)


@dataclass(frozen=True)
class Model:
    """The effects found, and what remains.

    Attributes:
        members: Strongest first as they were found.
        change: What they change together.
        observed: What was recorded against the baseline.
        residual: Of the whitened statistics.
        first: The residual before any effect.
        baseline: Fitted beside the effects.
        started: As it was before there were any.
    """

    members: tuple[Member, ...]
    change: Change | None
    observed: Change
    residual: Point
    first: Point
    baseline: Baseline
    started: Baseline


def foreseen(members: Sequence[Member], stepped: Sequence[Member]) -> Change:
    """Return what a step of the members changes, to first order."""
    total = members[0].changes[0] * 0.0
    for before, after in zip(members, stepped, strict=True):
        logs = [np.log(after.inner[name] / value) for name, value in before.inner.items()]
        steps = [after.strength - before.strength, *logs]
        for change, step in zip(before.changes, steps, strict=True):
            total = total + change * float(step)
    return total
