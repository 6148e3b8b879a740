"""When a fit ends: about its bent first baseline it may seem to have arrived before it began."""

from calib.diagnosis.given.known import beside
from calib.diagnosis.naming.settled import Turn, most_settled, stalled
from tests.calib.diagnosis.examinations import examined

NOTHING = beside(None, examined().evidence)


def turns(*each: tuple[float, float]) -> list[Turn]:
    return [Turn(NOTHING, ahead, misfit) for ahead, misfit in each]


def test_turns_that_come_nearer_go_on_however_good_the_first_one_seemed() -> None:
    coming = turns((0.02, 5386.0), (7.2, 5496.0), (5.6, 5417.0), (1.1, 5385.0), (0.03, 5384.0))
    assert not any(stalled(coming[:n]) for n in range(len(coming) + 1))
    assert most_settled(coming, 9000.0) is NOTHING


def test_two_turns_that_lead_nowhere_end_a_fit() -> None:
    going = turns((4.0, 900.0), (0.5, 800.0), (0.6, 801.0), (0.7, 802.0))
    assert [stalled(going[:n]) for n in range(5)] == [False] * 4 + [True]
