"""Derivatives hold as long as nothing has moved far from where they were taken."""

from dataclasses import replace

from calib.diagnosis.naming.derivatives import NEAR, is_near
from calib.forward.effects.lag import Lag
from tests.calib.diagnosis.examinations import examined


def test_derivatives_are_taken_anew_once_a_strength_or_another_parameter_has_moved_far() -> None:
    (member,) = examined((Lag(0.01),)).model.members
    member = replace(member, inner={"some_s": 2.0})
    moved = {
        share: replace(member, strength=member.strength * (1.0 + share * NEAR))
        for share in (0.9, -0.9, 1.1, -1.1)
    }
    near = [share for share, one in moved.items() if is_near((one,), (member,))]
    assert near == [0.9, -0.9]
    for some_s, holds in ((2.0, True), (2.15, True), (2.3, False), (1.7, False)):
        assert is_near((replace(member, inner={"some_s": some_s}),), (member,)) is holds
    assert not is_near((member,), ())
