"""The deciding measurement: what is expected of a plan is what the plan gives when it is run."""

import tomllib
from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from numpy.random import default_rng
from numpy.testing import assert_array_equal

from calib.diagnosis.deciding.bench import BenchTime, Taken, at_the_pace_of, timed
from calib.diagnosis.deciding.decide import chosen, judged_plans, next_measurement
from calib.diagnosis.deciding.family import Option, options
from calib.diagnosis.deciding.planned import with_planned
from calib.diagnosis.deciding.reduced import reduced
from calib.diagnosis.deciding.rivals import Rivals, is_open, rivals_of
from calib.diagnosis.deciding.separation import distance
from calib.diagnosis.deciding.testable import newly_testable
from calib.diagnosis.diagnose import Examination, examine
from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.evidence.growing import Growing
from calib.diagnosis.naming.model import Member
from calib.diagnosis.shapes.shape import Shape
from calib.diagnosis.signatures.changes import change_of
from calib.diagnosis.signatures.signature import Signature
from calib.diagnosis.simulation.fitted_responder import responder_of
from calib.diagnosis.statistics.peak import Peak
from calib.forward.departure import Departure
from calib.forward.effect import Effect
from calib.forward.effects.dark_current import DarkCurrent
from calib.forward.effects.hot_pixels import HotPixels
from calib.forward.effects.stray_light import StrayLight
from calib.recording.header import Block, RecordingHeader
from tests.calib.diagnosis.recordings import plain_model, recorded

COLUMNS, LINES = 48, 150
BENCH = BenchTime(1400.0, settle_s=1.0, block_s=0.2, max_level=4.0, target_s=1.0, starts_in_s=5.0)
AGCAM = [(t, 1.0) for t in (200.0, 400.0, 600.0, 800.0, 1000.0)] + [
    (200.0, float(level)) for level in (1, 2, 3, 4)
]
STRAY = StrayLight(0.004)
WANTED = 1.5
"""Four names at once are parted by so many sigma at least: a dark gives 2.09 +- 0.05 here."""


def blocks_of(rows: Sequence[tuple[float, float]], first: int = 0) -> list[Block]:
    return [
        Block(
            block=f"{first + k:03d}", kind="flat" if level else "dark", exposure_us=t, level=level,
            lines=LINES,
        )
        for k, (t, level) in enumerate(rows)
    ]  # fmt: skip


def measured(rows: Sequence[tuple[float, float]], *effects: Effect) -> Evidence:
    return recorded(plain_model(COLUMNS), blocks_of(rows), default_rng(), effects)


@cache
def stray() -> Examination:
    """Return AgCam's plan without darks, in stray light that no such plan tells from a late end."""
    return examine(measured(AGCAM, STRAY))


def rivals() -> Rivals:
    found = next(f for f in stray().diagnosis.findings if is_open(f))
    return rivals_of(found, stray())


def with_dark() -> Option:
    return next(o for o in options(stray().evidence, BENCH) if o.what.startswith("a dark at"))


def explained(evidence: Evidence, effect: Departure) -> float:
    """Return the deviance that an effect of any strength explains."""
    point = evidence.point(change_of((effect,), evidence, responder_of(evidence)))
    residual = evidence.point(evidence.observed())
    return evidence.product(point, residual) ** 2 / evidence.product(point, point)


def test_agcams_plan_leaves_stray_light_open_and_a_dark_tells_it() -> None:
    assert "stray_light" in rivals().names
    evidence = stray().evidence
    judged = judged_plans(rivals(), evidence, BENCH, WANTED, 1e9)
    assert judged[0].seconds <= judged[-1].seconds
    best = chosen(judged, WANTED)
    assert best is judged[-1]
    assert best.sigma >= WANTED > 3.0 * distance(rivals(), evidence)
    assert any(taken.block.kind == "dark" for taken in best.option.plan)
    header = RecordingHeader(camera=plain_model(COLUMNS).camera, blocks=evidence.table.blocks)
    asked = next_measurement(stray(), header, BENCH, wanted_sigma=WANTED)
    assert asked is not None
    assert asked.reached
    assert asked.expected_sigma == pytest.approx(best.sigma, rel=1e-9)
    assert tomllib.loads(asked.answer()["plan_toml"]) == asked.plan


def test_the_expected_separation_is_what_recordings_give() -> None:
    pair = next(m for m in rivals().members if m.effect.name != "stray_light")
    own = next(m for m in rivals().members if m.effect.name == "stray_light")
    taken, _ = timed(with_dark().plan, BENCH, float(stray().evidence.table.started_s[-1]) + 5.0)
    expected = distance(Rivals((own, pair), ()), with_planned(stray().evidence, taken))
    rows = [*AGCAM, (1000.0, 0.0)]
    z = []
    for _ in range(12):
        evidence = measured(rows, STRAY)
        won = explained(evidence, own.effect) - explained(evidence, pair.effect)
        # The difference of two squared projections is d^2 +- 2 d.
        z.append((won - expected**2) / (2.0 * expected))
    # The expectation grows with a strength that one recording gave, and so do z: by d of each part.
    of_strength = expected * own.std[0] / abs(own.strength)
    assert abs(np.mean(z)) < 4.0 * np.hypot(1.0 / np.sqrt(len(z)), of_strength)
    assert 1.0 - 3.0 / np.sqrt(2 * len(z)) < np.std(z) < 1.0 + 4.0 / np.sqrt(2 * len(z))


def test_planned_blocks_hold_what_the_baseline_expects_of_recorded_ones() -> None:
    evidence = measured([*AGCAM, (1000.0, 0.0)])
    taken = [b.model_copy(update={"started_s": 99.0 + k}) for k, b in enumerate(blocks_of(AGCAM))]
    both = with_planned(evidence, taken)
    assert both.n_blocks == evidence.n_blocks + len(AGCAM)
    n = evidence.n_blocks
    assert np.allclose(both.baseline.mean_dn[n:], evidence.baseline.mean_dn[: len(AGCAM)])
    assert np.allclose(both.pooled.std[n:], evidence.pooled.std[: len(AGCAM)], rtol=1e-6)
    observed = both.observed()
    assert np.abs(observed.means[n:]).max() == 0.0


def test_no_plan_saturates_and_each_costs_its_lines_and_lamps() -> None:
    evidence = measured([(1000.0, 0.0), (500.0, 2.0), (1000.0, 2.0), (1000.0, 1.0)])
    base = evidence.baseline
    for option in options(evidence, BENCH):
        taken, seconds = timed(option.plan, BENCH, 100.0)
        lines = sum(int(b.lines or 0) for b in taken)
        waits = sum(each.wait_s for each in option.plan)
        assert seconds >= lines * 1400e-6 + waits + BENCH.settle_s
        dose = max(b.exposure_us * b.level for b in taken)
        assert np.median(base.offset_dn + base.slope * dose) < 0.9 * 4095
        assert [b.started_s for b in taken] == sorted(b.started_s or 0.0 for b in taken)


def test_a_smaller_sensor_stands_for_the_whole_one() -> None:
    whole = stray().evidence
    there, small, factor = reduced(rivals(), whole, COLUMNS // 3)
    assert factor == pytest.approx(np.sqrt(3.0))
    assert reduced(rivals(), whole)[1] is whole
    taken, _ = timed(with_dark().plan, BENCH, float(whole.table.started_s[-1]) + 5.0)
    full = distance(rivals(), with_planned(whole, taken))
    part = distance(there, with_planned(small, taken))
    # The middle third is brighter by the vignette than all are: a few per cent of shot noise.
    assert abs(part * factor / full - 1.0) < 0.2


@pytest.mark.parametrize("rows", [None, 12])
@pytest.mark.parametrize("pixels", [(3, 140), (1, 70, 130), (2,)])
def test_hot_pixels_are_worth_on_a_smaller_sensor_what_they_are_on_the_whole(
    pixels: tuple[int, ...], rows: int | None
) -> None:
    darks = blocks_of([(t, 0.0) for t in (200.0, 400.0, 600.0, 800.0, 1000.0)])
    evidence = recorded(plain_model(192, rows=rows), darks, default_rng())
    rates = tuple(0.002 * (1.0 + k) for k in range(len(pixels)))
    hot = Shape(HotPixels(pixels=pixels, rates_e_per_us=rates), (("rates_e_per_us", rates, 0.0),),
                two_sided=False)  # fmt: skip
    rival = Shape(DarkCurrent(1e-4, 0.0), (("electrons_per_us", 1e-4, 0.0),), two_sided=False)
    pair = Rivals(tuple(as_member(shape, evidence) for shape in (hot, rival)), ())
    there, small, factor = reduced(pair, evidence, columns=64)
    assert factor > 1.7
    # Left out, moved without being scaled, or scaled alone, they would be off by a third and more.
    assert distance(there, small) * factor == pytest.approx(distance(pair, evidence), rel=0.15)


def test_rates_told_for_every_pixel_are_those_of_the_window() -> None:
    evidence = recorded(plain_model(24, rows=12), blocks_of([(200.0, 0.0)] * 3), default_rng())
    rates = tuple(np.arange(288.0).tolist())
    own = Shape(DarkCurrent(rates_e_per_us=rates), (("rates_e_per_us", rates, 0.0),), False)
    there, _, _ = reduced(Rivals((as_member(own, evidence),), ()), evidence, columns=8)
    inside = np.arange(288.0).reshape(12, 24)[:8, 8:16]
    effect = there.members[0].effect
    assert isinstance(effect, DarkCurrent)
    assert_array_equal(effect.rates_e_per_us, inside.ravel())


def as_member(shape: Shape, evidence: Evidence) -> Member:
    change = change_of((shape.at(1.0),), evidence, responder_of(evidence))
    signature = Signature(shape, 1.0, change, evidence.point(change), 1.0)
    return Member(signature, 1.0, {}, (), (), ())


def test_the_pace_is_that_of_the_recording() -> None:
    evidence = measured(AGCAM)
    # Simulated blocks follow one another, but where lamps are switched.
    assert at_the_pace_of(evidence.table, BENCH).block_s == pytest.approx(0.0, abs=1e-6)


def test_a_plan_makes_testable_what_it_has_and_nothing_else() -> None:
    evidence = measured([(200.0, 1.0), (400.0, 1.0), (600.0, 1.0)])
    dark = Taken(blocks_of([(200.0, 0.0)])[0], 1.0)
    level = Taken(blocks_of([(200.0, 2.0)])[0], 2.0)
    assert "stray_light" in newly_testable((level,), evidence)
    assert "stray_light" not in newly_testable((dark,), evidence)
    asked = next_measurement(
        examine(evidence), RecordingHeader(camera=plain_model(COLUMNS).camera, blocks=()), BENCH
    )
    assert asked is not None
    assert "stray_light" in asked.makes_testable
    assert asked.expected_sigma is None


def test_a_tone_of_the_recording_says_nothing_of_planned_blocks() -> None:
    recorded = stray().evidence
    n = recorded.n_blocks
    tone = Peak(0.2, 3, (2.0,) * n, (0.1,) * n, 50.0)
    planned = [b.model_copy(update={"started_s": 99.0 + k}) for k, b in enumerate(blocks_of(AGCAM))]
    both = with_planned(replace(recorded, known_peaks=(tone,)), planned)
    by_block = both.without_blocks(np.zeros(0, np.intp))  # where tones come last
    whitened = by_block.point(both.observed()).rest[-both.n_blocks :]
    assert (whitened[:n] > 0.0).all()
    assert (whitened[n:] == 0.0).all()


def test_a_scene_may_be_planned_for_frames_beside_pixels_that_grow() -> None:
    model = plain_model(COLUMNS, rows=12)
    evidence = recorded(model, blocks_of([*AGCAM, (1000.0, 0.0)]), default_rng())
    growing = Growing(np.array([5]), np.array([0.01]), np.full((evidence.n_blocks, 1), 9.0))
    scene = Block(block="s", kind="scene", exposure_us=800.0, level=1.0, lines=20, started_s=99.0)
    both = with_planned(replace(evidence, growing=growing), [scene])
    _, small, factor = reduced(Rivals((), ()), with_planned(evidence, [scene]), columns=24)
    assert both.point(both.observed()).means.shape == (both.n_blocks, 12 * COLUMNS)
    assert small.point(small.observed()).means.shape == (both.n_blocks, 8 * 24)
    assert factor == pytest.approx(np.sqrt(12 * COLUMNS / (8 * 24)))
