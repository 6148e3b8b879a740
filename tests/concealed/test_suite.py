"""The suite, the seal, and that every mechanism of every shape makes a recording."""

import numpy as np
import pytest

from tests.concealed.generator.answer import take_case
from tests.concealed.generator.case import Case, Hidden
from tests.concealed.generator.catalogue import ALL, LISTED, UNLISTED
from tests.concealed.generator.chain import take
from tests.concealed.generator.seal import opened, sealed
from tests.concealed.generator.suite import FULL, PART, suite

SHAPES = [(name, shape) for name, kind in ALL.items() for shape in (*kind.shapes, *kind.foreign)]


@pytest.mark.parametrize(("name", "shape"), SHAPES)
def test_every_mechanism_changes_codes_where_it_is_obvious(name: str, shape: str) -> None:
    case = Case(0, "single", (Hidden(name, shape, 1.0),), 17, 40_000)
    sensor, plan = case.setting.sensor, case.setting.plan
    taken, answer = take_case(case)
    plain = list(take(sensor, plan, (), case.rng("noise")))
    assert {block.codes.shape[1:] for block in taken} == {sensor.shape}
    assert max(int(block.codes.max()) for block in taken) <= sensor.top_code
    assert answer.told["effects"][0]["name"] == name
    same = [np.array_equal(a.codes, b.codes) for a, b in zip(taken, plain, strict=True)]
    assert not all(same)


def test_every_listed_effect_of_the_catalogue_is_there() -> None:
    assert len(LISTED) == 33
    assert len(UNLISTED) >= 6
    foreign = [name for name, kind in LISTED.items() if kind.foreign]
    assert len(foreign) == len(LISTED)


def test_the_suite_follows_from_its_origin_and_its_numbers_tell_nothing() -> None:
    first, again, other = suite("abc", PART), suite("abc", PART), suite("abd", PART)
    assert first == again
    assert [case.seed for case in first] != [case.seed for case in other]
    assert [case.kind for case in first] != [case.kind for case in other]
    assert [case.number for case in first] == list(range(len(first)))


def test_the_full_suite_holds_what_the_proof_asks_for() -> None:
    cases = suite("abc", FULL)
    assert sum(case.kind == "clean" for case in cases) >= 300
    for name in LISTED:
        rungs = {case.hidden[0].rung for case in cases
                 if case.kind == "single" and case.hidden[0].name == name}  # fmt: skip
        assert len(rungs) >= 8
    assert {case.hidden[0].name for case in cases if case.kind == "unlisted"} == set(UNLISTED)
    assert all(case.most_pixels <= 600_000 for case in cases)


def test_a_seal_binds_and_hides() -> None:
    answer = take_case(Case(3, "single", (Hidden("lag", "each_electron", 0.9),), 4, 30_000))[1]
    key = bytes(range(32))
    content, digest = sealed(answer, key)
    assert sealed(answer, key) == (content, digest)
    assert b"lag" not in content
    found = opened(content, key)
    assert found.told == answer.told
    assert all(np.array_equal(found.arrays[k], v) for k, v in answer.arrays.items())
    changed = content[:-1] + bytes([content[-1] ^ 1])
    for bad, other in ((changed, key), (content, bytes(32))):
        with pytest.raises(ValueError, match="seal"):
            opened(bad, other)
