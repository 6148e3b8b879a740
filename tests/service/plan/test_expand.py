import pytest

from service.plan.expand import blocks, expand, planned_header
from tests.service.plan.plans import factorial, plan


def conditions(**changes):
    """Return (kind, exposure / 100 µs, what burns) of every step."""
    steps = expand(plan(**changes))
    return [(s.block.kind[0], s.block.exposure_us / 100, s.burning) for s in steps]


def flats(**changes):
    return [(exposure, level) for kind, exposure, level in conditions(**changes) if kind == "f"]


TWO = {"type": "exposure", "exposures_us": [100.0, 200.0], "level": 3}

PLACEMENTS = {
    "interleaved": ["d1", "f1", "d2", "f2"],
    "before": ["d1", "d2", "f1", "f2"],
    "after": ["f1", "f2", "d1", "d2"],
    "none": ["f1", "f2"],
}


@pytest.mark.parametrize(("placement", "wanted"), PLACEMENTS.items(), ids=PLACEMENTS)
def test_darks_go_where_the_plan_says(placement, wanted):
    taken = conditions(sweep=TWO, darks=placement)
    assert [f"{kind}{exposure:g}" for kind, exposure, _ in taken] == wanted


def test_darks_are_interleaved_unless_told_otherwise():
    assert conditions(sweep=TWO) == conditions(sweep=TWO, darks="interleaved")


def test_interleaved_darks_are_spread_over_a_level_major_sweep():
    taken = conditions(sweep=factorial(3, 2), order="level_major")
    at = [i for i, (kind, _, _) in enumerate(taken) if kind == "d"]
    assert at == [0, 3, 6]
    assert {taken[i][1] for i in at} == {1.0, 2.0, 3.0}


def test_a_dark_changes_no_lamp():
    taken = conditions(sweep=factorial(3, 2), order="level_major", darks={"per_exposure": 2})
    burning = [level for _, _, level in taken]
    assert burning == sorted(burning)


def test_a_dark_has_level_and_radiance_zero():
    dark = expand(plan(source={"radiance": {"1": 5.0}}))[0]
    assert dark.capped
    assert (dark.block.level, dark.block.radiance) == (0.0, 0.0)


def test_darks_are_taken_at_each_exposure_of_each_repeat():
    taken = conditions(sweep=TWO, repeats=3, darks={"per_exposure": 2})
    darks = [exposure for kind, exposure, _ in taken if kind == "d"]
    assert sorted(darks) == [1.0] * 6 + [2.0] * 6


def test_a_factorial_is_every_exposure_at_every_level_once():
    taken = flats(sweep=factorial(3, 2))
    assert sorted(taken) == [(e, lv) for e in (1.0, 2.0, 3.0) for lv in (1.0, 2.0)]


def test_a_level_sweep_holds_the_exposure():
    sweep = {"type": "level", "levels": [1, 2, 4], "exposure_us": 200.0}
    assert flats(sweep=sweep) == [(2.0, 1.0), (2.0, 2.0), (2.0, 4.0)]


def test_reversed_is_as_given_backwards():
    assert flats(sweep=factorial(), order="reversed") == flats(sweep=factorial())[::-1]


def test_level_major_lights_each_lamp_once():
    levels = [level for _, level in flats(sweep=factorial(4, 3), order="level_major")]
    assert levels == sorted(levels)


def test_random_is_the_same_for_the_same_seed_and_different_in_each_repeat():
    once = flats(sweep=factorial(4, 3), repeats=2, order={"type": "random", "seed": 5})
    assert once == flats(sweep=factorial(4, 3), repeats=2, order={"type": "random", "seed": 5})
    assert once != flats(sweep=factorial(4, 3), repeats=2, order={"type": "random", "seed": 6})
    first, second = once[:12], once[12:]
    assert first != second
    assert sorted(first) == sorted(second) == sorted(flats(sweep=factorial(4, 3)))


def test_blocks_are_named_in_the_order_of_acquisition():
    names = [block.block for block in blocks(plan(repeats=400))]
    assert names == sorted(names)
    assert len(set(names)) == 2400
    assert expand(plan())[0].block.block == "000"


def test_listed_blocks_are_taken_as_they_stand():
    listed = [
        {"kind": "flat", "exposure_us": 100.0, "level": 2},
        {"kind": "dark", "exposure_us": 300.0, "level": 2, "lines": 32, "wait_s": 60.0},
        {"kind": "scene", "exposure_us": 200.0, "level": 1, "scene": "landscape"},
    ]
    steps = expand(plan(sweep={"type": "listed", "blocks": listed}, order="reversed"))
    assert [s.block.kind for s in steps] == ["flat", "dark", "scene"]
    assert (steps[1].lines, steps[1].wait_s, steps[1].burning) == (32, 60.0, 2.0)
    assert steps[2].block.scene == "landscape"


def test_radiance_comes_from_the_table_and_is_unknown_where_it_is_silent():
    taken = blocks(plan(sweep=factorial(1, 2), source={"radiance": {"2": 7.5}}, darks="none"))
    assert [block.radiance for block in taken] == [None, 7.5]


def test_lamps_go_off_after_those_levels_that_the_plan_names():
    mode = {"per_level": {"2": "off_between_blocks"}}
    steps = expand(plan(sweep=factorial(1, 2), lamps=mode, darks="none"))
    assert [step.off_afterwards for step in steps] == [False, True]


def test_the_header_is_that_of_a_recording():
    header = planned_header(plan(camera={"line_period_us": 1000.0, "band": "NIR"}), columns=48)
    assert (header.camera.columns, header.camera.bit_depth, header.camera.band) == (48, 12, "NIR")
    assert len(header.blocks) == 6
    assert header.source.lamps == 1
