"""Charge that repels charge: its strength is that of the covariances, whatever profiles lose."""

from calib.forward.effects.brighter_fatter import BrighterFatter
from tests.calib.diagnosis.examinations import examined

STRONG = BrighterFatter(1e-5)


def test_profiles_tell_nothing_of_how_strongly_charge_repels() -> None:
    seen = examined((STRONG,))
    (member,) = seen.model.members
    assert isinstance(member.effect, BrighterFatter)
    # A border sweeps the flux of both its pixels, or the fuller one's own: half as much, or all.
    assert member.changes[0].means.any()
    assert not member.directions[0].means.any()
    error = member.effect.row_per_e / STRONG.row_per_e - 1.0
    relative_std = member.std[0] / abs(member.strength)
    assert abs(error) < 4.5 * relative_std
