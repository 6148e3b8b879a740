"""Derivatives hold as long as nothing has moved far from where they were taken."""

from dataclasses import replace
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.evidence.point import Point
from calib.diagnosis.naming.derivatives import FAINT, NEAR, which_moved
from calib.diagnosis.naming.model import Member
from calib.diagnosis.naming.refit import reachable
from calib.diagnosis.shapes.shape import Shape
from calib.diagnosis.signatures.signature import Signature
from calib.forward.effects.lag import Lag


class Whitened:
    """Points of one number each."""

    def product(self, one: Point, other: Point) -> float:
        return float(one.rest @ other.rest)


EVIDENCE = cast("Evidence", Whitened())
SLOPE = Point(np.zeros((0, 0)), np.array([10.0]))
MEMBER = Member(cast("Signature", None), -3.0, {"some_s": 2.0}, (), (), (SLOPE,))


@pytest.mark.parametrize(
    ("share", "holds"), [(0.0, True), (0.9, True), (-0.9, True), (1.1, False), (-1.1, False)]
)
def test_a_strength_may_move_by_a_share_of_itself(share: float, holds: bool) -> None:
    moved = replace(MEMBER, strength=MEMBER.strength * (1.0 + share * NEAR))
    # All are taken anew where one is.
    told = which_moved((moved, MEMBER), (MEMBER, MEMBER), EVIDENCE)
    assert told == ([] if holds else [0, 1])


@pytest.mark.parametrize(
    ("some_s", "holds"), [(2.0, True), (2.15, True), (2.3, False), (1.7, False)]
)
def test_so_may_what_else_is_fitted(some_s: float, holds: bool) -> None:
    moved = replace(MEMBER, inner={"some_s": some_s})
    assert which_moved((moved,), (MEMBER,), EVIDENCE) == ([] if holds else [0])


@pytest.mark.parametrize(("sigma", "alone"), [(0.9, True), (1.1, False)])
def test_one_that_fades_moves_alone(sigma: float, alone: bool) -> None:
    then = replace(MEMBER, strength=sigma * FAINT / 10.0)
    now = replace(then, strength=0.25 * then.strength)
    assert which_moved((MEMBER, now), (MEMBER, then), EVIDENCE) == ([1] if alone else [0, 1])


def test_nothing_is_near_before_any_derivative_was_taken() -> None:
    assert which_moved((MEMBER,), (), EVIDENCE) == [0]


def test_a_strength_that_has_a_sign_steps_to_nothing_at_the_farthest() -> None:
    def of(two_sided: bool) -> Member:
        shape = Shape(Lag(0.01), (), two_sided)
        return replace(MEMBER, signature=cast("Signature", SimpleNamespace(shape=shape)),
                       strength=3.0, directions=(SLOPE, SLOPE))  # fmt: skip

    steps = np.array([-4.0, -5.0, -4.0, 7.0])
    assert reachable(steps, (of(False), of(True))).tolist() == [-3.0, -5.0, -4.0, 7.0]
