import pytest

from drivers.aravis.frame_ids import FrameIds


def all_missing(ids: list[int]) -> list[tuple[int, ...]]:
    follow = FrameIds()
    return [follow.missing_before(frame_id) for frame_id in ids]


@pytest.mark.parametrize(
    ("ids", "missing"),
    [
        ([7], [()]),
        ([1, 2, 3], [(), (), ()]),
        ([1, 2, 5], [(), (), (3, 4)]),
        ([65534, 65535, 1, 2], [(), (), (), ()]),
        ([65533, 2], [(), (65534, 65535, 1)]),
        ([65535, 2], [(), (1,)]),
        ([65535, 65536, 65537], [(), (), ()]),  # 64-bit ids count on
        ([65534, 65537], [(), (65535, 65536)]),
        ([2**40, 2**40 + 2], [(), (2**40 + 1,)]),
        ([0, 1, 3], [(), (), (2,)]),  # USB3 Vision starts from 0
    ],
)
def test_gaps_are_named(ids: list[int], missing: list[tuple[int, ...]]) -> None:
    assert all_missing(ids) == missing


def test_three_times_round_without_a_gap() -> None:
    follow = FrameIds()
    assert not any(follow.missing_before(n % 65535 + 1) for n in range(3 * 65535))


def test_late_frame_is_known_as_missed_and_moves_nothing() -> None:
    follow = FrameIds()
    follow.missing_before(10)
    assert follow.missing_before(12) == (11,)
    assert follow.missing_before(11) == ()
    assert follow.was_missed(11)
    assert follow.missing_before(13) == ()
    assert not follow.was_missed(13)


@pytest.mark.parametrize(
    ("last", "frame_id", "may_be"),
    [
        (None, 0, False),  # a fresh buffer
        (None, 5, True),
        (65411, 0, False),
        (65411, 65395, False),  # what was in the buffer sixteen frames ago
        (65411, 65412, True),
        (65535, 1, True),
        (3, 65530, False),
    ],
)
def test_id_of_a_damaged_frame_is_believed_only_where_it_can_be(
    last: int | None, frame_id: int, may_be: bool
) -> None:
    follow = FrameIds()
    if last is not None:
        follow.missing_before(last)
    assert follow.may_be_next(frame_id) is may_be
