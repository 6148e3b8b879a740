"""Bits that stick and codes that are wide: what the counts of single codes say of either."""

import numpy as np
import pytest
from numpy.random import default_rng

from calib.diagnosis.diagnose import examine
from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.naming.search import THRESHOLD
from calib.diagnosis.shapes.told_shapes import told_shapes
from calib.diagnosis.signatures.all_signatures import all_signatures
from calib.diagnosis.signatures.changes import change_of
from calib.diagnosis.signatures.code_credit import LOW_BITS, with_code_credit
from calib.diagnosis.simulation.fitted_responder import responder_of
from calib.forward.departure import Departure
from calib.forward.effects.adc_dnl import AdcDnl
from calib.forward.effects.stuck_bit import StuckBit
from tests.calib.diagnosis.recordings import plain_model, plan, recorded

BITS = 12
FOURTH = AdcDnl(0.0, widths_dn=(1.21, 0.93, 0.93, 0.93) * (1 << BITS - 2), bit_depth=BITS)
STUCK = StuckBit(0.1, 1, 1)


def drawn(effect: Departure) -> Evidence:
    rng = default_rng()
    return recorded(plain_model(96, bits=BITS), plan(rng, 80, twice=0), rng, (effect,))


@pytest.mark.parametrize(("effect", "other"), [(FOURTH, StuckBit), (STUCK, AdcDnl)])
def test_what_single_codes_contradict_has_a_price(
    effect: Departure, other: type[Departure]
) -> None:
    evidence = drawn(effect)
    told, responder = told_shapes(evidence), responder_of(evidence)
    shapes = [told[AdcDnl.name], told[StuckBit.name]]
    found = with_code_credit(all_signatures(shapes, evidence, responder, lambda _: None), evidence)
    cost: dict[str, float] = {}
    for each in found:
        name, template = each.shape.name, each.shape.template
        low = isinstance(template, StuckBit) and template.bit < LOW_BITS
        if low or (isinstance(template, AdcDnl) and template.widths_dn):
            cost[name] = min(cost.get(name, np.inf), each.shape.cost)
    # A bit that sticks makes a comb of widths as well, which has two numbers more to follow chance:
    # in 24 of deviance once in 100,000 draws.
    if other is StuckBit:
        assert cost[StuckBit.name] > cost[effect.name] + 24.0
    else:
        assert cost[effect.name] < cost[AdcDnl.name] + 24.0


def test_a_weak_comb_is_credited_with_what_its_counts_say() -> None:
    evidence = drawn(AdcDnl(0.0, widths_dn=(1.03, 0.97), bit_depth=BITS))
    shapes = [told_shapes(evidence)[AdcDnl.name]]
    signatures = all_signatures(shapes, evidence, responder_of(evidence), lambda _: None)
    most = max(each.shape.of_codes for each in with_code_credit(signatures, evidence))
    counts = evidence.code_counts
    numbers = counts.whitened(counts.residual())
    # 0.03^2 of 92,000 samples and more are 83 of deviance, a normal number of 9.1 squared.
    told = most + max(float(numbers @ numbers) - len(numbers), 0.0)
    assert told > (9.1 - 4.5) ** 2


def test_what_a_strong_comb_errs_by_is_no_other_name() -> None:
    strong = AdcDnl(0.0, widths_dn=(1.6, 0.4), bit_depth=BITS)
    evidence = drawn(strong)
    responder = responder_of(evidence)
    shapes = [told_shapes(evidence)[StuckBit.name]]
    signatures = all_signatures(shapes, evidence, responder, lambda _: None)
    # 5 % of 0.6, squared, of 92,000 samples and more are 83 of deviance.
    told = 0.95 * change_of((strong,), evidence, responder).codes[0]
    found = with_code_credit(signatures, evidence, told)
    assert max(each.shape.of_codes for each in found) < THRESHOLD


@pytest.mark.parametrize("value", [0, 1])
def test_a_lowest_bit_that_always_sticks_is_named(value: int) -> None:
    rng, always = default_rng(), StuckBit(1.0, 0, value)
    evidence = recorded(plain_model(96, bits=BITS), plan(rng, 80, twice=0), rng, (always,))
    found = examine(evidence).diagnosis.findings
    # Every other code missing is the same.
    assert found[0].effect.name in {StuckBit.name, AdcDnl.name}


def test_codes_of_widths_are_those_that_are_counted() -> None:
    evidence = drawn(FOURTH)
    change = change_of((FOURTH,), evidence, responder_of(evidence))
    counts = evidence.code_counts
    left = counts.contrasts.over_std(counts.residual()[0] - change.codes[0])
    # Squares of n standard normal numbers at the most: some errors of means are allowed for.
    std = np.sqrt(2.0 * len(left))
    assert float(left @ left) < len(left) + 5.0 * std
    seen = counts.contrasts.over_std(counts.residual()[0])
    # They are seen by some 15 of these standard deviations, which scatter by two.
    assert float(seen @ seen) > len(left) + 5.0 * std
