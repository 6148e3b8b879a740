from datetime import datetime

import pytest

from calib.errors import InputError
from service.store.actor import Actor
from service.store.errors import IllegalTransitionError, NotInStoreError
from service.store.state import NEXT, SetState
from service.store.store import Store
from tests.service.store.a_store import a_set, certified, day, take_step, verified


def test_a_set_begins_as_draft_and_its_file_is_named_by_its_content(store: Store) -> None:
    coefficients = a_set()
    record = store.sets.add(coefficients, by=Actor("ada"))
    assert record.state is SetState.DRAFT
    assert record.id == coefficients.id
    assert store.sets.files.path(record.id).name == f"{coefficients.id}.h5"
    assert store.sets.files.load(record.id).id == coefficients.id


def test_adding_a_set_twice_changes_nothing(store: Store) -> None:
    first = verified(store, a_set())
    assert store.sets.add(a_set(), by=Actor("somebody else")) == first


def test_every_step_of_a_life_is_written_down(store: Store) -> None:
    record = certified(store, a_set(), day(1))
    record = store.sets.revoke(record.id, by=Actor("grace"), reason="the lamp had been replaced")
    steps = [(step.before, step.after, step.by, step.reason) for step in record.transitions]
    assert steps == [
        (None, "draft", "ada", "added"),
        ("draft", "verified", "ada", "curves look right"),
        ("verified", "certified", "grace", "annual calibration"),
        ("certified", "revoked", "grace", "the lamp had been replaced"),
    ]
    times = [step.at for step in record.transitions]
    assert times == sorted(times)


def test_a_change_of_state_changes_the_version(store: Store) -> None:
    draft = store.sets.add(a_set(), by=Actor("ada"))
    assert store.sets.verify(draft.id, by=Actor("ada")).version != draft.version


ILLEGAL = {
    "draft-certified": "certify",
    "draft-revoked": "revoke",
    "verified-verified": "verify",
    "verified-revoked": "revoke",
    "certified-verified": "verify",
    "certified-certified": "certify",
    "revoked-verified": "verify",
    "revoked-certified": "certify",
    "revoked-revoked": "revoke",
}


@pytest.mark.parametrize("case", ILLEGAL)
def test_a_life_goes_only_forwards(store: Store, case: str) -> None:
    before = SetState(case.partition("-")[0])
    set_id = store.sets.add(a_set(), by=Actor("ada")).id
    if before is not SetState.DRAFT:
        store.sets.verify(set_id, by=Actor("ada"))
    if before in {SetState.CERTIFIED, SetState.REVOKED}:
        store.sets.certify(
            set_id, valid_from=day(1), valid_until=None, by=Actor("ada"), reason="due"
        )
    if before is SetState.REVOKED:
        store.sets.revoke(set_id, by=Actor("ada"), reason="wrong")
    with pytest.raises(IllegalTransitionError) as refused:
        take_step(store, set_id, ILLEGAL[case])
    assert refused.value.code == "illegal-transition"
    assert store.sets.get(set_id).state is before


def test_every_state_knows_what_follows() -> None:
    assert set(NEXT) == set(SetState)


@pytest.mark.parametrize("step", ["verify", "certify"])
def test_an_altered_file_is_neither_verified_nor_certified(store: Store, step: str) -> None:
    set_id = (
        verified(store, a_set()).id
        if step == "certify"
        else store.sets.add(a_set(), by=Actor("a")).id
    )
    other = a_set(31.0)
    path = store.sets.files.path(set_id)
    path.unlink()
    other.save(path)
    with pytest.raises(InputError) as refused:
        take_step(store, set_id, step)
    assert refused.value.code == "altered"
    assert len(store.sets.get(set_id).transitions) == (1 if step == "verify" else 2)


def test_a_damaged_file_is_written_anew_when_the_set_is_added_again(store: Store) -> None:
    set_id = store.sets.add(a_set(), by=Actor("ada")).id
    store.sets.files.path(set_id).write_bytes(b"not HDF5")
    store.sets.add(a_set(), by=Actor("ada"))
    assert store.sets.files.load(set_id).id == set_id


def test_a_certification_needs_a_reason_and_a_range_that_ends_after_its_start(store: Store) -> None:
    set_id = verified(store, a_set()).id
    for reason, until, code in (
        (" ", day(3), "no-reason"),
        ("due", day(2), "bad-validity"),
        ("due", day(1), "bad-validity"),
        ("due", datetime(2026, 5, 1), "naive-time"),
    ):
        with pytest.raises(InputError) as refused:
            store.sets.certify(
                set_id, valid_from=day(2), valid_until=until, by=Actor("a"), reason=reason
            )
        assert refused.value.code == code
    assert store.sets.get(set_id).state is SetState.VERIFIED


def test_a_set_is_found_by_the_beginning_of_its_id(store: Store) -> None:
    set_id = store.sets.add(a_set(), by=Actor("ada")).id
    assert store.sets.get(set_id[:8]).id == set_id
    for unknown in (set_id[:7], "f" * 64, "", "%" * 10, "_" * 12):
        with pytest.raises(NotInStoreError):
            store.sets.get(unknown)
