"""What faults of codes do, told by the codes' chances, against samples that are drawn."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.random import default_rng
from scipy.stats import chi2

from calib.diagnosis.diagnose import examine
from calib.diagnosis.recorded.sensor import Sensor
from calib.diagnosis.shapes.faulty_tap import faulty_tap
from calib.diagnosis.shapes.shape import Shape
from calib.diagnosis.shapes.told_shapes import suspect_bits, told_shapes
from calib.diagnosis.signatures import signature as signatures
from calib.diagnosis.signatures.changes import change_of
from calib.diagnosis.simulation.fault_moments import PixelCodes
from calib.diagnosis.simulation.fitted_responder import responder_of
from calib.diagnosis.statistics.change import Change
from calib.diagnosis.statistics.gather import block_sums
from calib.forward.code_fault import CodeFault
from calib.forward.departure import Departure
from calib.forward.effect import Effect
from calib.forward.effects.black_clip import BlackClip
from calib.forward.effects.exposure_offset import ExposureOffset
from calib.forward.effects.line_noise import LineNoise
from calib.forward.effects.stuck_bit import StuckBit
from calib.forward.effects.tap_crosstalk import TapCrosstalk
from calib.recording.header import CameraHeader
from tests.calib.diagnosis.recordings import plain_model, plan, recorded

TOP, SAMPLES = 1023, 4000


@pytest.mark.parametrize(
    "fault", [StuckBit(0.3, 2, 1), StuckBit(0.02, 5, 0), StuckBit(0.2, 7, 1), BlackClip(198)]
)
def test_moments_of_faulty_codes_are_those_of_drawn_ones(fault: CodeFault) -> None:
    rng = default_rng()
    means, noise = np.linspace(190.0, 260.0, 40), 4.0
    codes = np.rint(means + noise * rng.standard_normal((SAMPLES, len(means))))
    codes = np.where(rng.random(codes.shape) < fault.chance, fault.faulty(codes), codes)
    variance = np.full(len(means), noise**2 + 1.0 / 12.0)
    sigma = np.full(len(means), noise)
    told = PixelCodes.of(means, variance, sigma, TOP).moments((fault,))
    cut = 5.0 * noise + 1.0
    off = codes - told.mean
    within = np.abs(off) <= cut
    kept = np.where(within, off, 0.0)
    seen_and_told = (
        (kept, 0.0 * told.mean, told.squares),
        (kept**2, told.squares, told.fourths - told.squares**2),
        (kept**4, told.fourths, cut**4 * told.fourths),
        (1.0 * ~within, told.out, told.out * (1.0 - told.out)),
    )
    for values, expected, spread in seen_and_told:
        # Of 40 pixels one is off by six standard errors by chance in 10 million draws, but for
        # rare samples, of which three more may happen to one.
        std = np.sqrt(np.maximum(spread, 0.0) / SAMPLES)
        few = 3.0 * np.abs(values).max() / SAMPLES
        assert (np.abs(values.mean(axis=0) - expected) <= 6.0 * std + few).all()


@pytest.mark.parametrize("chance", [0.02, 0.1])
def test_samples_that_jump_far_widen_no_cut(chance: float) -> None:
    rng = default_rng()
    sensor = Sensor(CameraHeader(columns=128, bit_depth=12, taps=1, tap_layout="single"))
    codes = np.rint(600.0 + 6.0 * rng.standard_normal((100, 1, 128)))
    bits = StuckBit(chance, 7, 1)
    jumped = np.where(rng.random(codes.shape) < chance, bits.faulty(codes), codes)
    sums = block_sums(jumped.astype(np.uint16), sensor, 1 << 20)
    moved = (jumped != codes).sum(axis=(0, 1))
    # A jump of 128 DN is 21 standard deviations; each of them lies beyond the cut. So does, of
    # 12,800 others, one by chance in a run of fifty: three of them in a million runs at most.
    others = sums.products.outliers[0] - moved
    assert others.min() >= 0
    assert others.sum() <= 2
    # Each of 100 samples is off by 7 %, their median by six standard errors of that at most.
    assert abs(np.median(sums.sigma_dn) / 6.0 - 1.0) < 6.0 * 1.25 * 0.075 / np.sqrt(128)


@pytest.mark.parametrize("fault", [StuckBit(0.3, 1, 0), StuckBit(0.1, 2, 1)])
def test_codes_are_told_about_own_means_whatever_else_moves_these(fault: StuckBit) -> None:
    rng = default_rng()
    others = (ExposureOffset(6.0), TapCrosstalk(0.05, "odd_even"))
    model = plain_model(96, bits=14, taps=2, layout="odd_even")
    evidence = recorded(model, plan(rng), rng, (*others, fault))
    assert suspect_bits(evidence)[0] == fault.bit
    shapes = told_shapes(evidence)[StuckBit.name]
    told = next(s.at(1.0) for s in shapes if s.template == replace(fault, probability=0.5))
    # Some 1e6 samples, a half of which have the bit; means of codes hold a part of what is told.
    assert isinstance(told, StuckBit)
    assert abs(told.probability / fault.probability - 1.0) < 0.1
    where = evidence.whitening.places["codes"]
    change = change_of((fault,), evidence, responder_of(evidence))
    left = (evidence.point(evidence.observed()) - evidence.point(change)).rest[where]
    # Roughness, the last but two: a sum of squares of what is seen scatters by more than one of
    # chance, by sqrt(1 + 2.7 R / sqrt(4 n)) of n codes that are compared, below 3 here.
    left[-3] /= 3.0
    assert np.abs(left).max() < 5.0


def test_a_fault_is_taken_once_and_once_more_where_somebody_asks_how_it_grows(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    rng = default_rng()
    evidence = recorded(plain_model(48), plan(rng, 20), rng)
    taken: list[tuple[Departure, ...]] = []

    def counted(effects: tuple[Departure, ...], *rest: Any, **more: Any) -> Change:
        taken.append(effects)
        return change_of(effects, *rest, **more)

    monkeypatch.setattr(signatures, "change_of", counted)
    shape = Shape(StuckBit(bit=4, value=1), (("probability", 0.1, 0.0),), two_sided=False)
    one = signatures.signature(shape, evidence, responder_of(evidence))
    assert one is not None
    assert taken == [(shape.at(1.0),)]
    assert one.power == replace(one, strength=1.0).power
    assert taken == [(shape.at(1.0),), (shape.at(1.2),)]


def test_a_bit_that_sticks_beside_a_stop_leaves_of_the_noise_what_is_told() -> None:
    rng, faults = default_rng(), (BlackClip(64), StuckBit(0.17, 4, 1))
    model, blocks = plain_model(96, taps=2, layout="odd_even"), plan(rng, twice=0)
    clean = recorded(model, blocks, rng).baseline
    evidence = recorded(model, blocks, rng, faults)
    # Of the links as they are, not as a plain fit takes jumps of 16 DN for read noise.
    links = replace(
        evidence.baseline,
        offset_dn=clean.offset_dn,
        slope=clean.slope,
        gain_dn_per_e=clean.gain_dn_per_e,
        read_variance_dn2=clean.read_variance_dn2,
    )
    change = change_of(faults, evidence, responder_of(evidence).about(links))
    left = evidence.point(evidence.observed()) - evidence.point(change)
    z = left.rest[evidence.whitening.places["pooled"]]
    n = int(evidence.pooled.used.sum())
    # The links err, too: a tenth. Drawn lines, or noise that passes a stop as light does: 300,000.
    assert float(z @ z) < chi2.isf(1e-8, n) + 0.1 * n


@pytest.mark.parametrize(
    "fault", [StuckBit(0.1, 8, 1), pytest.param(StuckBit(0.2, 4, 0), marks=pytest.mark.soak)]
)
def test_effects_are_found_beside_a_bit_that_sticks(fault: Effect) -> None:
    rng = default_rng()
    others = (ExposureOffset(6.0), LineNoise(0.4))
    evidence = recorded(plain_model(96), plan(rng, 60, twice=0), rng, (*others, fault))
    found = examine(evidence).diagnosis
    names = {finding.effect.name for finding in found.findings}
    assert names == {fault.name, *(each.name for each in others)}
    assert found.verdict != "unexplained"


@pytest.mark.parametrize("tap", [None, 0, 1])
def test_bits_that_flip_in_one_tap_alone_are_that_taps(tap: int | None) -> None:
    rng = default_rng()
    fault = StuckBit(0.05, 7, 1, only_tap=tap, tap_layout="odd_even")
    model = plain_model(96, taps=2, layout="odd_even")
    evidence = recorded(model, plan(rng, 30, twice=0), rng, (fault,))
    # Some hundred samples of 128 DN each; of both taps alike one in a billion has 0.9 by chance.
    assert faulty_tap(7, 1, evidence) == tap


@pytest.mark.soak
def test_a_bit_that_sticks_in_one_tap_is_named_with_its_tap() -> None:
    rng = default_rng()
    fault = StuckBit(0.15, 7, 1, only_tap=1, tap_layout="odd_even")
    model = plain_model(96, taps=2, layout="odd_even")
    found = examine(recorded(model, plan(rng, 60, twice=0), rng, (fault,))).diagnosis
    assert [finding.effect.name for finding in found.findings] == [fault.name]
    told = found.findings[0].parameters["probability"]
    assert found.findings[0].effect == replace(fault, probability=told.value)
    assert abs(told.value - fault.probability) < 5.0 * told.std
