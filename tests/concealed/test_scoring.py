"""Scoring, held against a diagnosis whose behaviour is known."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import binom, norm

from calib.forward.effects.catalogue import effect_named
from calib.forward.parameter import parameters_of
from tests.concealed.generator.answer import Answer
from tests.concealed.generator.catalogue import LISTED
from tests.concealed.scoring.confusion import confusion
from tests.concealed.scoring.intervals import Share
from tests.concealed.scoring.rates import (
    by_sigma,
    clearly,
    complete,
    covered,
    false_alarm,
    half_named_sigma,
    ideal_rate,
    ideal_threshold,
    named_first,
    of_kind,
    wrongly_named,
)
from tests.concealed.scoring.reliability import (
    expected_calibration_error,
    reliability_curve,
    statements,
)
from tests.concealed.scoring.strengths import COMPARED, strength_z
from tests.concealed.scoring.summary import as_markdown, claims
from tests.concealed.scripted import finding, honest_run, named, truth

RNG = np.random.default_rng


def test_the_exact_interval_covers_at_least_as_often_as_it_says() -> None:
    n = 40
    shares = [Share(k, n) for k in range(n + 1)]
    for p in (0.01, 0.05, 0.5, 0.93):
        inside = [share.low <= p <= share.high for share in shares]
        assert binom.pmf(np.arange(n + 1), n, p)[inside].sum() >= 0.95
    assert Share(0, 300).high == pytest.approx(1 - 0.025 ** (1 / 300))


def test_what_counts_as_named_covered_complete_and_wrong() -> None:
    lag = (truth("lag", 9.0),)
    right = named("single", lag, (finding("lag", 0.9, "cti"),))
    second = named("single", lag, (finding("cti", 0.6, "lag"),))
    crowd = named("single", lag, (finding("cti", 0.4, "lag", "banding", "line_noise"),))
    wrong = named("single", lag, (finding("cti", 0.9, "banding"),))
    nothing = named("single", lag, ())
    five = (right, second, crowd, wrong, nothing)
    assert [named_first(one) for one in five] == [True, False, False, False, False]
    assert [covered(one) for one in five] == [True, True, False, False, False]
    assert [wrongly_named(one) for one in five] == [False, False, False, True, False]
    both = (truth("lag", 9.0), truth("cti", 8.0))
    assert complete(named("double", both, (finding("cti", 0.9), finding("lag", 0.9))))
    assert not complete(named("double", both, (finding("cti", 0.9),)))
    assert false_alarm(named("clean", (), (), unexplained=True))
    assert not false_alarm(named("clean", (), ()))


@pytest.mark.parametrize("loss", [1.0, 2.0])
def test_the_sight_at_which_half_are_named_is_found(loss: float) -> None:
    every = list(honest_run(RNG(1), loss, repeats=40))
    single = of_kind(every, "single")
    seen = [named("single", one.truths, (finding(one.truths[0].name, 0.9),) if one.findings else ())
            for one in single]  # fmt: skip
    # Of 40 x 33 cases some 300 lie where it is open: 6 % of a step of one standard deviation.
    assert half_named_sigma(seen) / (loss * ideal_threshold()) == pytest.approx(1.0, abs=0.15)


def test_half_are_named_later_where_names_are_confused_however_clear_they_are() -> None:
    kept, ratios = 0.8, []
    expected = ideal_threshold() + norm.ppf(0.5 / kept)
    for rng in map(RNG, range(7, 11)):
        seen = []
        for one in of_kind(honest_run(rng, repeats=60), "single"):
            name = one.truths[0].name if rng.random() < kept else "none"
            found = (finding(name, 0.9),) if one.findings else ()
            seen.append(named("single", one.truths, found))
        ratios.append(half_named_sigma(seen) / expected)
    # One fit scatters by 3.5 %. Taken for the logistic's middle it would be 9 % too low.
    assert np.mean(ratios) == pytest.approx(1.0, abs=4 * 0.035 / np.sqrt(len(ratios)))


def test_a_diagnosis_like_the_ideal_filter_lies_on_its_curve() -> None:
    every = of_kind(honest_run(RNG(2)), "single")
    for _, share in by_sigma(every, lambda one: bool(one.findings)):
        sigma = [one.truths[0].sigma for one in every]
        assert share.n <= len(sigma)
    for low, high in ((0.5, 2.0), (2.0, 4.0), (4.0, 7.0)):
        inside = [one for one in every if low <= one.truths[0].sigma < high]
        expected = [ideal_rate(one.truths[0].sigma) for one in inside]
        spread = np.sqrt(sum(p * (1 - p) for p in expected))
        hits = sum(bool(one.findings) for one in inside)
        assert abs(hits - sum(expected)) < 4 * spread


def test_honest_probabilities_are_found_reliable_and_boasts_are_not() -> None:
    stated = statements(honest_run(RNG(3)))
    curve = reliability_curve(stated)
    n = sum(one.right.n for one in curve)
    assert n == len(stated)
    # Of n honest statements the error is about the sum of the bins' own standard errors.
    chance = sum(np.sqrt(one.right.n * 0.25) for one in curve[3:]) / n
    assert expected_calibration_error(curve[3:]) < 3 * chance
    boasting = reliability_curve([(min(1.0, p + 0.3), right) for p, right in stated if p > 0.5])
    assert expected_calibration_error(boasting) > 0.15
    assert not all(one.kept for one in boasting)


def test_rates_of_a_known_diagnosis_are_within_their_errors() -> None:
    every = list(honest_run(RNG(4)))
    for kind, test, rate in (
        ("clean", false_alarm, 0.02), ("double", complete, 0.93), ("triple", complete, 0.80),
    ):  # fmt: skip
        share = Share.of(test(one) for one in of_kind(every, kind))
        assert abs(share.value - rate) < 4 * np.sqrt(rate * (1 - rate) / share.n)


def test_the_confusion_matrix_counts_every_case_of_one_effect_once() -> None:
    every = clearly(honest_run(RNG(5)))
    hidden, given, counts = confusion(every)
    assert counts.sum() == sum(len(one.truths) == 1 for one in every)
    assert counts[hidden.index("lag"), given.index("lag")] > 0
    assert counts[: len(LISTED)].trace() == sum(
        named_first(one) for one in every if len(one.truths) == 1
    )


def test_the_tables_name_every_effect_and_every_claim() -> None:
    every = list(honest_run(RNG(6), repeats=20))
    text = as_markdown(every)
    assert all(f"| {name} |" in text for name in LISTED)
    assert text.count("\n| ") > len(LISTED) + len(claims(every))
    reached = {claim.text: claim.reached for claim in claims(every)}
    assert reached["false alarms on clean recordings"] is True
    assert (
        reached["named first, where clearly seen and told apart"] is False
    )  # three in four, by its own word
    assert claims([])[0].reached is None


def test_parameters_are_held_against_what_was_hidden() -> None:
    rng = RNG(5)
    stated, true, std = 0.0121, 0.012, 0.0002
    effect = {
        "name": "interpixel_capacitance",
        "shape": "nearest",
        "parameters": {"strength": true},
    }
    bent = {"name": "nonlinearity", "shape": "quadratic",
            "parameters": {"strength": 0.01, "sign": -1.0}}  # fmt: skip
    other = {"name": "lag", "shape": "barrier", "parameters": {"strength": 0.1}}
    told = {"effects": [effect, bent, other], "scale": {"top_signal_dn": 2000.0}}
    names = ("interpixel_capacitance", "nonlinearity", "lag", "banding")
    case = replace(
        named("triple", (), tuple(finding(name, 0.9, "cti") for name in names)),
        parameters=(
            {"column_coupling": {"value": stated, "std": std}},
            {"beta_per_dn": {"value": -5.2e-6, "std": 1e-7}},
            {"share": {"value": 0.1, "std": 0.01}},
            {"amplitude_dn": {"value": rng.uniform(), "std": 0.1}},
        ),
        answer=Answer(told, {}),
    )
    found = strength_z([case])
    assert [name for name, _ in found] == ["interpixel_capacitance", "nonlinearity"]
    assert [z for _, z in found] == pytest.approx([0.5, -2.0])


def test_every_comparison_is_with_a_shape_that_is_hidden_and_a_parameter_that_is_fitted() -> None:
    for name, compared in COMPARED.items():
        assert set(compared.shapes) <= set(LISTED[name].shapes)
        assert compared.parameter in parameters_of(effect_named(name))
