"""Derivatives hold as long as nothing has moved far from where they were taken."""

from dataclasses import replace
from typing import cast

import pytest

from calib.diagnosis.naming.derivatives import NEAR, is_near
from calib.diagnosis.naming.model import Member
from calib.diagnosis.naming.signatures import Signature

MEMBER = Member(cast("Signature", None), -3.0, {"some_s": 2.0}, (), (), ())


@pytest.mark.parametrize(
    ("share", "holds"), [(0.0, True), (0.9, True), (-0.9, True), (1.1, False), (-1.1, False)]
)
def test_a_strength_may_move_by_a_share_of_itself(share: float, holds: bool) -> None:
    moved = replace(MEMBER, strength=MEMBER.strength * (1.0 + share * NEAR))
    assert is_near((moved, MEMBER), (MEMBER, MEMBER)) is holds


@pytest.mark.parametrize(
    ("some_s", "holds"), [(2.0, True), (2.15, True), (2.3, False), (1.7, False)]
)
def test_so_may_what_else_is_fitted(some_s: float, holds: bool) -> None:
    assert is_near((replace(MEMBER, inner={"some_s": some_s}),), (MEMBER,)) is holds


def test_nothing_is_near_before_any_derivative_was_taken() -> None:
    assert not is_near((MEMBER,), ())
