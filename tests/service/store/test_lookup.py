from datetime import datetime, timedelta, timezone

import pytest

from calib.errors import InputError
from service.store.actor import Actor
from service.store.errors import NotInStoreError, OverlapError
from service.store.state import SetState
from service.store.store import Store
from tests.service.store.a_store import SETTING, a_set, certified, day, verified


def test_the_set_in_force_is_the_certified_one_whose_validity_covers_the_time(store: Store) -> None:
    first = certified(store, a_set(30.0), day(1), day(6))
    second = certified(store, a_set(31.0), day(6), None)
    verified(store, a_set(32.0))
    for at, wanted in ((day(1), first), (day(5, 31), first), (day(6), second), (day(12), second)):
        assert store.sets.lookup(**SETTING, at=at).id == wanted.id
    with pytest.raises(NotInStoreError):
        store.sets.lookup(**SETTING, at=day(1) - timedelta(microseconds=1))


@pytest.mark.parametrize(
    "change", [{"serial": "B0002"}, {"band": "red"}, {"gain_db": 6.0}, {"bit_depth": 8}]
)
def test_another_camera_setting_is_another_question(store: Store, change: dict[str, str]) -> None:
    certified(store, a_set(), day(1))
    with pytest.raises(NotInStoreError):
        store.sets.lookup(**{**SETTING, **change}, at=day(2))


@pytest.mark.parametrize(
    ("start", "end"),
    [(day(2), day(3)), (day(1), day(12)), (day(5, 31), None), (day(1), day(2, 2)), (day(2), None)],
)
def test_an_overlapping_certification_is_refused_unless_it_names_the_other(
    store: Store, start: datetime, end: datetime | None
) -> None:
    standing = certified(store, a_set(30.0), day(2), day(6))
    later = verified(store, a_set(31.0))
    with pytest.raises(OverlapError) as refused:
        store.sets.certify(later.id, valid_from=start, valid_until=end, by=Actor("g"), reason="due")
    assert refused.value.standing == (standing.id,)
    assert store.sets.get(later.id).state is SetState.VERIFIED
    assert store.sets.get(standing.id).state is SetState.CERTIFIED
    store.sets.certify(
        later.id,
        valid_from=start,
        valid_until=end,
        by=Actor("g"),
        reason="due",
        supersedes=[standing.id],
    )
    assert store.sets.get(standing.id).state is SetState.SUPERSEDED
    assert store.sets.lookup(**SETTING, at=max(start, day(2))).id == later.id


def test_neither_another_camera_nor_a_touching_range_overlaps(store: Store) -> None:
    certified(store, a_set(30.0), day(2), day(6))
    certified(store, a_set(31.0), day(6), day(7))
    certified(store, a_set(32.0), day(1), day(2))
    certified(store, a_set(33.0, serial="B0002"), day(1))
    certified(store, a_set(34.0, band="red"), day(1))
    certified(store, a_set(35.0, gain_db=6.0), day(1))
    certified(store, a_set(36.0, bit_depth=10), day(1))
    certified(store, a_set(37.0, first_column=32), day(1))


def test_sets_of_two_regions_of_a_sensor_are_told_apart(store: Store) -> None:
    left = certified(store, a_set(30.0), day(1))
    assert store.sets.lookup(**SETTING, at=day(2)).id == left.id
    right = certified(store, a_set(31.0, first_column=32), day(1))
    with pytest.raises(InputError, match="0:32 and 32:64") as refused:
        store.sets.lookup(**SETTING, at=day(2))
    assert refused.value.code == "several-regions"
    assert store.sets.lookup(**SETTING, at=day(2), region="0:32").id == left.id
    assert store.sets.lookup(**SETTING, at=day(2), region="32:64").id == right.id
    with pytest.raises(NotInStoreError):
        store.sets.lookup(**SETTING, at=day(2), region="0:64")


def test_what_was_taken_before_a_set_was_superseded_is_still_corrected_by_it(store: Store) -> None:
    old = certified(store, a_set(30.0), day(1), day(12))
    new = certified(store, a_set(31.0), day(5), day(8), supersedes=[old.id])
    assert store.sets.lookup(**SETTING, at=day(4)).id == old.id
    assert store.sets.lookup(**SETTING, at=day(7)).id == new.id
    with pytest.raises(NotInStoreError):  # for good: it does not come back behind its successor
        store.sets.lookup(**SETTING, at=day(9))
    record = store.sets.get(old.id)
    assert record.certification is not None
    assert record.certification.superseded_by == new.id
    assert record.certification.until == day(5)


def test_a_superseded_set_leaves_room_behind_its_end(store: Store) -> None:
    old = certified(store, a_set(30.0), day(1), day(12))
    certified(store, a_set(31.0), day(5), day(8), supersedes=[old.id])
    late = certified(store, a_set(32.0), day(8))
    assert store.sets.lookup(**SETTING, at=day(9)).id == late.id


def test_a_superseded_set_that_is_found_wrong_can_be_revoked(store: Store) -> None:
    old = certified(store, a_set(30.0), day(1))
    certified(store, a_set(31.0), day(5), supersedes=[old.id])
    store.sets.revoke(old.id, by=Actor("grace"), reason="lamp 3 was off")
    with pytest.raises(NotInStoreError):
        store.sets.lookup(**SETTING, at=day(2))


def test_a_revoked_set_holds_for_no_time_and_leaves_its_range_free(store: Store) -> None:
    wrong = certified(store, a_set(30.0), day(1))
    store.sets.revoke(wrong.id, by=Actor("grace"), reason="lamp 3 was off")
    with pytest.raises(NotInStoreError):
        store.sets.lookup(**SETTING, at=day(2))
    right = certified(store, a_set(31.0), day(1))
    assert store.sets.lookup(**SETTING, at=day(2)).id == right.id


def test_times_come_back_in_utc_whatever_zone_they_were_given_in(store: Store) -> None:
    tokyo = timezone(timedelta(hours=9))
    record = certified(store, a_set(), datetime(2026, 3, 1, 9, tzinfo=tokyo))
    assert record.certification is not None
    again = store.sets.get(record.id)
    assert again.certification is not None
    assert again.certification.valid_from == day(3)
    assert again.certification.valid_from.utcoffset() == timedelta(0)
    assert all(step.at.utcoffset() == timedelta(0) for step in again.transitions)
    assert store.sets.lookup(**SETTING, at=datetime(2026, 3, 1, 9, tzinfo=tokyo)).id == record.id
    with pytest.raises(NotInStoreError):
        store.sets.lookup(**SETTING, at=datetime(2026, 3, 1, 8, 59, tzinfo=tokyo))


def test_a_time_without_zone_is_refused(store: Store) -> None:
    with pytest.raises(InputError) as refused:
        store.sets.lookup(**SETTING, at=datetime(2026, 3, 1))
    assert refused.value.code == "naive-time"


def test_pages_give_every_set_once_although_one_is_added_meanwhile(store: Store) -> None:
    wanted = [store.sets.add(a_set(30.0 + i), by=Actor("ada")).id for i in range(5)]
    first = store.sets.list(limit=2)
    store.sets.add(a_set(99.0), by=Actor("ada"))
    second = store.sets.list(limit=2, before=first.next_before)
    third = store.sets.list(limit=2, before=second.next_before)
    found = [record.id for record in (*first.items, *second.items, *third.items)]
    assert found == wanted[::-1]
    assert third.next_before is None


def test_filters_narrow_the_list(store: Store) -> None:
    here = verified(store, a_set(30.0))
    store.sets.add(a_set(31.0), by=Actor("ada"))
    store.sets.add(a_set(32.0, serial="B0002", band="red"), by=Actor("ada"))
    assert [each.id for each in store.sets.list(state=SetState.VERIFIED).items] == [here.id]
    assert len(store.sets.list(serial="B0002").items) == 1
    assert len(store.sets.list(band="NIR").items) == 2
    assert len(store.sets.list(recording="0" * 64).items) == 3
    assert store.sets.list(recording="1" * 64).items == ()
