"""What holds of every effect of the catalogue, the next one included."""

import tomllib
from typing import Any

import numpy as np
import pytest
import tomli_w
from numpy.typing import NDArray

from calib.errors import InputError
from calib.forward.conditions import Conditions
from calib.forward.departure import Departure
from calib.forward.effect import Effect
from calib.forward.effects.catalogue import CATALOGUE, effect_named
from calib.forward.parameter import from_table, parameters_of, to_table
from tests.calib.forward.strengths import neutral, shown

AT = Conditions.steady(
    6, exposure_us=40.0, line_period_us=50.0, started_s=3.0, lamps=(0.8,), gain_db=2.0
)
AT_REST = Conditions.steady(6, exposure_us=40.0, line_period_us=50.0)
every_effect = pytest.mark.parametrize("kind", CATALOGUE, ids=lambda kind: kind.name)
SAMPLES = {"line": (32,), "frame": (4, 8)}
lines_and_frames = pytest.mark.parametrize("sample", SAMPLES.values(), ids=SAMPLES)


def signal(sample: tuple[int, ...]) -> NDArray[np.float64]:
    return np.random.default_rng(2).integers(100, 900, (6, *sample)).astype(np.float64)


@lines_and_frames
@every_effect
def test_keeps_the_shape_and_leaves_its_input(kind: type[Effect], sample: tuple[int, ...]) -> None:
    before = signal(sample)
    given = before.copy()
    given.flags.writeable = False
    after = kind().apply(given, AT, np.random.default_rng(1))
    assert after.shape == before.shape
    assert after is not given
    assert np.array_equal(given, before)
    assert np.isfinite(after).all()


@lines_and_frames
@every_effect
def test_same_seed_gives_same_answer_and_other_seed_another_if_stochastic(
    kind: type[Effect], sample: tuple[int, ...]
) -> None:
    first, again, *others = (
        shown(kind).apply(signal(sample), AT, np.random.default_rng(seed))
        for seed in (5, *range(5, 205))
    )
    assert np.array_equal(first, again)
    # What seldom happens does not happen with every seed.
    differ = any(not np.array_equal(first, other) for other in others)
    assert differ == kind.stochastic


@lines_and_frames
@every_effect
def test_zero_strength_changes_nothing(kind: type[Effect], sample: tuple[int, ...]) -> None:
    none = neutral(kind)
    if none is not None:
        after = none.apply(signal(sample), AT_REST, np.random.default_rng(1))
        assert np.array_equal(after, signal(sample))
    else:
        assert not kind().apply(np.zeros((6, *sample)), AT_REST, np.random.default_rng(1)).any()


@lines_and_frames
@pytest.mark.parametrize("kind", [k for k in CATALOGUE if k.separable], ids=lambda kind: kind.name)
def test_a_separable_effect_treats_one_line_as_all_lines(
    kind: type[Effect], sample: tuple[int, ...]
) -> None:
    effect, rng = kind(), np.random.default_rng(1)
    row = signal(sample)[:1]
    full = effect.apply(np.repeat(row, 6, axis=0), AT, np.random.default_rng(1))
    factor = effect.line_factor(AT, np.random.default_rng(1))
    if factor is None:
        assert np.array_equal(full, np.repeat(effect.apply(row, AT, rng), 6, axis=0))
        zero, one, two = (effect.apply(k * row, AT, rng) for k in (0.0, 1.0, 2.0))
        assert np.allclose(two - one, one - zero, rtol=1e-12)
    else:
        assert np.allclose(full, np.multiply.outer(factor, row[0]), rtol=1e-15)


@lines_and_frames
@pytest.mark.parametrize("kind", [k for k in CATALOGUE if k.by_signal], ids=lambda kind: kind.name)
def test_an_effect_by_signal_asks_for_no_conditions(
    kind: type[Effect], sample: tuple[int, ...]
) -> None:
    nothing: Any = object()
    effect = shown(kind)
    alone = effect.apply(signal(sample), nothing, np.random.default_rng(1))
    assert np.array_equal(alone, effect.apply(signal(sample), AT, np.random.default_rng(1)))


@every_effect
def test_survives_toml(kind: type[Effect]) -> None:
    for effect in (kind(), neutral(kind) or kind()):
        table = tomllib.loads(tomli_w.dumps(to_table(effect)))
        assert from_table(kind, table, "here") == effect


@every_effect
def test_says_unit_bounds_default_and_meaning_of_each_parameter(kind: type[Effect]) -> None:
    for name, told in parameters_of(kind).items():
        assert told.unit or told.choices, name
        assert told.low < told.high
        assert name in (kind.__doc__ or ""), f"{name} is not in the docstring"
    assert "Source:" in (__import__(kind.__module__, fromlist=["_"]).__doc__ or "")


@every_effect
def test_refuses_values_out_of_bounds_and_unknown_keys(kind: type[Effect]) -> None:
    for name, told in parameters_of(kind).items():
        for bad in (told.low - 1 - abs(told.low) * 1e-3, told.high * 1.01 + 1, float("nan")):
            if told.choices or not np.isfinite([told.low, told.high]).any():
                continue
            if bad in (float("-inf"), float("inf")):
                continue
            value: Any = (bad,) if isinstance(getattr(kind(), name), tuple) else bad
            with pytest.raises(InputError, match=name) as caught:
                kind(**{name: value})
            assert caught.value.code == "parameter-out-of-bounds"
    with pytest.raises(InputError, match="'strenth'") as caught:
        from_table(kind, {"strenth": 1.0}, "model.toml")
    assert caught.value.code == "unknown-key"
    assert "allowed" in str(caught.value)


def test_names_are_unique_and_stages_in_order() -> None:
    stages = [kind.stage for kind in CATALOGUE]
    assert stages == sorted(stages)
    assert len({kind.name for kind in CATALOGUE}) == len(CATALOGUE)
    assert all(effect_named(kind.name) is kind for kind in CATALOGUE)


def test_an_unknown_effect_is_named_with_the_known_ones() -> None:
    with pytest.raises(InputError, match=r"vignete.*vignette") as caught:
        effect_named("vignete")
    assert caught.value.code == "unknown-effect"


@pytest.mark.parametrize(
    "kind", [k for k in CATALOGUE if issubclass(k, Departure)], ids=lambda kind: kind.name
)
def test_a_departure_says_what_it_is_and_where_it_shows(kind: type[Departure]) -> None:
    assert kind.physics.endswith(".")
    assert kind.shows_in
    assert kind.depends_on
    absent = neutral(kind)
    assert absent is not None, "its absence has no name"
    assert absent.conditions_after(AT) == AT
