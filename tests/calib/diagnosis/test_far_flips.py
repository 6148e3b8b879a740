"""Bits that stick now and then, told from tails and tracks by what single samples say."""

import numpy as np
import pytest
from numpy.random import Generator, default_rng

from calib.arrays import Lines
from calib.diagnosis.diagnose import examine
from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.naming.search import THRESHOLD
from calib.diagnosis.shapes.far_credit import FarCredit, far_credit
from calib.diagnosis.shapes.far_flips import share_set
from calib.forward.conditions import Conditions
from calib.forward.effect import Effect
from calib.forward.effects.heavy_tailed_noise import HeavyTailedNoise
from calib.forward.effects.stuck_bit import StuckBit
from tests.calib.diagnosis.recordings import plain_model, plan, recorded

BIT = 4


class OnceABlock(StuckBit):
    """Sticks once in each dark block and never else: so many times, whatever chance does."""

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:
        faulty, found = self.faulty(signal), signal.copy()
        could = np.argwhere(faulty != signal)
        if signal.mean() < 70.0 and len(could):
            place = tuple(could[rng.integers(len(could))])
            found[place] = faulty[place]
        return found


def drawn(*effects: Effect) -> Evidence:
    rng = default_rng()
    return recorded(plain_model(96), plan(rng, 100, twice=0), rng, effects)


def credit(*effects: Effect) -> FarCredit:
    return far_credit(drawn(*effects))


def test_three_flips_of_a_bit_are_no_tails() -> None:
    # Of 64 DN in the dark bit 7 is not set.
    bit, value = 7, 1
    evidence = drawn(OnceABlock(bit=bit, value=value))
    found = far_credit(evidence)
    assert next(iter(found.bits)) == (bit, value)
    # Charges of 180 DN give 128 to 1.2 DN a hundredth as often: 28 of deviance, of which the prices
    # take 4, and chance 3 or, once in 10,000, 21.
    assert found.bits[bit, value] > max(found.tails, found.rays)
    findings = examine(evidence).diagnosis.findings
    assert [each.effect.name for each in findings] == [StuckBit.name]


def test_readings_of_tails_are_no_flips() -> None:
    found = credit(HeavyTailedNoise(share=1e-3, std_e=72.0))
    assert found.tails > max(found.bits.values(), default=0.0) + THRESHOLD


def test_of_a_recording_of_chance_no_bit_is_credited() -> None:
    assert max(credit().bits.values(), default=0.0) < THRESHOLD


def test_bits_that_stick_are_credited_to_no_other() -> None:
    # 128 DN are beyond all noise, and always the same.
    found = credit(StuckBit(bit=7, value=1, probability=1e-3))
    assert max(found.tails, found.rays) < THRESHOLD
    assert next(iter(found.bits)) == (7, 1)


@pytest.mark.parametrize("mean", [63.3, 70.0, 80.2, 95.0])
def test_so_many_samples_have_a_bit_set(mean: float) -> None:
    codes = np.rint(default_rng().normal(mean, 3.0, 100_000)).astype(int)
    share = float((codes >> BIT & 1).mean())
    # Counts scatter by half of the root of their number, at the most.
    told = share_set(np.array(mean), np.array(3.0), 2.0**BIT)
    assert abs(share - float(told)) < 4.5 * 0.5 / np.sqrt(1e5)
