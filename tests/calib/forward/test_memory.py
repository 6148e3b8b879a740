"""Lines that depend on lines before them, within a draw, across draws and across blocks."""

from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from calib.forward.chain import expected_left
from calib.forward.conditions import Conditions
from calib.forward.effect import Effect
from calib.forward.effects.duplicated_lines import DuplicatedLines
from calib.forward.effects.lag import Lag
from calib.forward.effects.persistence import Persistence
from calib.forward.effects.rts_pixels import RtsPixels
from calib.forward.left import Left
from calib.forward.model import Model
from calib.forward.simulate import simulate
from calib.recording.header import Block
from drivers.mock.camera import MockCamera
from drivers.mock.world import World
from tests.calib.forward.plain_sensor import (
    COLUMNS,
    ELECTRONS_PER_LAMP,
    OFFSET_DN,
    PERIOD_US,
    block,
    covariance,
    plain,
    score,
)
from tests.contracts import simulated_area_camera, simulated_camera
from tests.contracts.camera import whole

FLOAT = NDArray[np.float64]
seeds = pytest.mark.parametrize("seed", [1, 2, 3])


def at(n_lines: int, started_s: float = 0.0, before: Left | None = None) -> Conditions:
    lit = Conditions.steady(
        n_lines, exposure_us=50.0, line_period_us=PERIOD_US, started_s=started_s, lamps=(1.0,)
    )
    return replace(lit, before=before)


def in_draws(model: Model, n_draws: int, n_lines: int, seed: int) -> Iterator[FLOAT]:
    """Draw after draw without a pause, each finding what the one before left."""
    rng, left = np.random.default_rng(seed), None
    for k in range(n_draws):
        drawn = model.draw(at(n_lines, k * n_lines * PERIOD_US * 1e-6, left), rng)
        left = drawn.left
        yield drawn.dn - OFFSET_DN


def taken(model: Model, blocks: list[Block], seed: int, **given: Any) -> dict[str, FLOAT]:
    rng, options = np.random.default_rng(seed), {"frame_lines": 10} | given
    drawn = simulate(model, blocks, rng, **options)
    return {b.block: np.concatenate(list(frames)) - OFFSET_DN for b, frames in drawn}


@seeds
def test_lag_makes_the_lines_after_a_step_wrong_by_powers_of_its_share(seed: int) -> None:
    rng, f, bright, dim, n = np.random.default_rng(seed), 0.3, 400.0, 50.0, 20_000
    lines = np.concatenate([rng.poisson(bright, (30, n)), rng.poisson(dim, (4, n))])
    read = Lag(share=f).apply(lines.astype(float), at(34), rng)
    for k, line in enumerate(read[30:]):
        off = f ** (k + 1) * (bright - dim)
        assert score(line.mean(), dim + off, np.sqrt((dim + off) / n)) < 5


@pytest.mark.parametrize("p", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("n_lines", [1, 8])
def test_lag_keeps_the_mean_and_correlates_lines_as_far_as_no_partition_noise_hides_it(
    p: float, n_lines: int
) -> None:
    f, m, n_draws = 0.3, ELECTRONS_PER_LAMP, 400 // n_lines
    model = plain(Lag(share=f, partition_noise=p))
    drawn = np.concatenate(list(in_draws(model, n_draws, n_lines, seed=4)))[25:]
    # As a linear filter, y(n) = (1 - f) sum over k of f^k q(n - k), where nothing else is drawn;
    # 1 - p^2 of that remains beside the Poisson counts that independent electrons give.
    smooth = (1 - f) ** 2 / (1 - f**2)
    variance = m * (p**2 + (1 - p**2) * smooth)
    rounding = 0.0 if p == 1.0 else 1 / 12
    size = drawn.size
    long_run = np.sqrt((1 + f) / (1 - f)) * np.sqrt(variance / size)
    assert score(drawn.mean(), m, long_run) < 5
    assert score(covariance(drawn, drawn), variance + rounding, variance * np.sqrt(2.5 / size)) < 5
    for d in (1, 2):
        wanted = (1 - p**2) * m * smooth * f**d
        found = covariance(drawn[:-d], drawn[d:])
        assert score(found, wanted, variance * np.sqrt(1.5 / size)) < 5, d


def test_lag_and_traps_move_whole_electrons_and_lose_none() -> None:
    rng = np.random.default_rng(7)
    lines = rng.poisson(300.0, (20, 50)).astype(float)
    for effect in (Lag(share=0.2), Persistence(share=0.2, time_constant_s=1e-3)):
        before = Left(0.0, {effect.name: np.full(50, 40.0)}, drawn=True)
        read, left = effect.carry(lines, at(20, before=before), rng)
        assert np.array_equal(read.sum(0) + left, lines.sum(0) + 40.0)
        assert np.array_equal(read, np.rint(read))
        assert read.min() >= 0


@seeds
def test_a_block_starts_with_what_the_block_before_left_the_first_with_none(seed: int) -> None:
    f, lit = 0.25, 4 * ELECTRONS_PER_LAMP
    blocks = [block("0", 4, lines=25), block("1", 0, lines=6, started_s=60.0), block("2", 1)]
    recording = taken(plain(Lag(share=f)), blocks, seed)
    first = recording["0"][0].mean()
    assert score(first, lit * (1 - f), np.sqrt(lit / COLUMNS)) < 5
    for k in range(3):
        dark = recording["1"][k]
        wanted = lit * f ** (k + 1)
        assert score(dark.mean(), wanted, np.sqrt(wanted / COLUMNS)) < 5
        assert score(dark.var(), wanted, wanted * np.sqrt(2.5 / COLUMNS)) < 5


@seeds
@pytest.mark.parametrize("p", [0.0, 0.6, 1.0])
def test_what_a_block_finds_of_lag_scatters_as_what_a_draw_leaves(seed: int, p: float) -> None:
    f, m, n, rng = 0.3, 800.0, 20_000, np.random.default_rng(seed)
    lag = Lag(share=f, partition_noise=p)
    kept = np.full(n, m * f / (1 - f))
    _, drawn = lag.carry(rng.poisson(m, (25, n)).astype(float), at(25), rng)
    dark, found = np.zeros((1, n)), []
    for state, is_drawn in ((drawn, True), (kept, False)):
        here = at(1, before=Left(0.0, {"lag": state}, drawn=is_drawn))
        found.append(lag.apply(dark, here, rng))
    (after_draw, after_expectation) = found
    spread = after_draw.var()
    mean_error = np.sqrt(2 * spread / n)
    assert score(after_expectation.mean(), after_draw.mean(), mean_error) < 5
    assert score(after_expectation.var(), spread, spread * np.sqrt(5.0 / n)) < 5


@seeds
def test_traps_that_hold_less_than_an_electron_release_it_now_and_then(seed: int) -> None:
    held, n, tau = 0.4, 40_000, 1e-3
    traps = Persistence(share=0.0, time_constant_s=tau)
    here = at(1, before=Left(0.0, {traps.name: np.full(n, held)}, drawn=False))
    read = traps.apply(np.zeros((1, n)), here, np.random.default_rng(seed))
    wanted = held * (1 - np.exp(-PERIOD_US * 1e-6 / tau))
    assert score(read.mean(), wanted, np.sqrt(wanted / n)) < 5
    assert score(read.var(), wanted, np.sqrt((wanted + 2 * wanted**2) / n)) < 5


@seeds
def test_traps_fill_and_then_no_more_is_lost(seed: int) -> None:
    share, filled_by, n_lines = 0.1, 20_000.0, 60
    traps, lit = Persistence(share, 1e4, filled_by), 4 * ELECTRONS_PER_LAMP
    lines = np.random.default_rng(seed).poisson(lit, (n_lines, COLUMNS)).astype(float)
    read, held = traps.carry(lines, at(n_lines), np.random.default_rng(seed))
    free = share * filled_by * np.exp(-lit / filled_by * np.arange(n_lines + 1))
    caught = -np.diff(free)
    # What light of mean m misses of exp(-m / F) by its own scatter, m / F^2 / 2, is 3e-6 a line.
    for n in (0, 20, 59):
        lost = (lines - read)[n]
        assert score(lost.mean(), caught[n], np.sqrt(caught[n] / COLUMNS)) < 5
    assert score(held.mean(), caught.sum(), np.sqrt(caught.sum() / COLUMNS)) < 5
    expected = traps.expected_left(np.full((1, COLUMNS), lit), at(n_lines))
    assert np.allclose(expected, caught.sum(), rtol=1e-5)


@pytest.mark.parametrize("filled_by", [3e2, 1e4, 1e12])
def test_steady_light_leaves_what_as_many_lines_leave_one_by_one(filled_by: float) -> None:
    traps = Persistence(0.2, 0.004, filled_by)
    before = Left(0.0, {traps.name: np.full(3, 25.0)}, drawn=False)
    here, lit = at(40, 0.001, before), np.array([0.0, 30.0, 3000.0])
    one_by_one = traps.expected_left(np.tile(lit, (40, 1)), here)
    assert np.allclose(traps.expected_left(lit[None], here), one_by_one, rtol=1e-9)


@pytest.mark.parametrize(
    "effect", [Lag(share=0.2), Persistence(share=0.1, time_constant_s=0.02)], ids=lambda e: e.name
)
def test_a_block_does_not_depend_on_the_frames_that_were_asked_for_before(effect: Effect) -> None:
    model = plain(effect, columns=64)
    blocks = [block("0", 4, lines=35), block("1", 0, lines=20)]
    whole_recording = taken(model, blocks, 5)
    for asked in (0, 1, 2):
        drawn = simulate(model, blocks, np.random.default_rng(5), frame_lines=10)
        _, frames = next(drawn)
        for _ in range(asked):
            next(frames)
        _, dark = next(drawn)
        assert np.array_equal(np.concatenate(list(dark)) - OFFSET_DN, whole_recording["1"])
    assert not np.array_equal(taken(model, blocks, 6)["1"], whole_recording["1"])


def trapped(lit: list[float], share: float, time_constant_s: float) -> float:
    """What traps hold after lines of so many electrons, line by line."""
    held = 0.0
    for electrons in lit:
        held += share * electrons - held * (1 - np.exp(-PERIOD_US * 1e-6 / time_constant_s))
    return held


@seeds
def test_persistence_leaks_a_bright_block_into_a_dark_one_and_decays(seed: int) -> None:
    share, tau, gap = 0.05, 0.02, 0.01
    model = plain(Persistence(share=share, time_constant_s=tau), columns=500)
    lit = 4 * ELECTRONS_PER_LAMP
    start = 300 * PERIOD_US * 1e-6 + gap
    blocks = [block("0", 4, lines=300), block("1", 0, lines=400, started_s=start)]
    recording = taken(model, blocks, seed, frame_lines=100)
    held = trapped([lit] * 300, share, tau) * np.exp(-gap / tau)
    per_line = held * (1 - np.exp(-PERIOD_US * 1e-6 / tau))
    decayed = per_line * np.exp(-np.arange(400) * PERIOD_US * 1e-6 / tau)
    for part in (slice(0, 50), slice(50, 200), slice(200, 400)):
        found, wanted = recording["1"][part].mean(), decayed[part].mean()
        assert score(found, wanted, np.sqrt(wanted / recording["1"][part].size)) < 5
    # In the bright block the traps fill: the last lines get back what they lose but for exp(-D/T).
    filling = lit * (1 - share * np.exp(-np.arange(300) * PERIOD_US * 1e-6 / tau))
    for part in (slice(0, 50), slice(250, 300)):
        found, wanted = recording["0"][part].mean(), filling[part].mean()
        assert score(found, wanted, np.sqrt(wanted / recording["0"][part].size)) < 5


@seeds
@pytest.mark.parametrize(
    "effect", [Lag(share=0.3), Persistence(share=0.1, time_constant_s=0.004)], ids=lambda e: e.name
)
def test_what_a_draw_leaves_has_the_expectation_that_simulate_hands_on(
    effect: Effect, seed: int
) -> None:
    model, rng = plain(effect), np.random.default_rng(seed)
    ramp = np.linspace(0.0, 60.0, 40)[:, np.newaxis] * np.ones(COLUMNS)
    first = model.draw(at(40), rng, ramp).left
    assert first is not None
    after = model.draw(at(20, 0.01, first), rng).left
    assert after is not None
    expected = expected_left(model.effects, ramp, at(40))
    expected = expected_left(model.effects, np.zeros((1, COLUMNS)), at(20, 0.01, expected))
    assert expected is not None
    assert (after.drawn, expected.drawn) == (True, False)
    assert after.at_s == expected.at_s == pytest.approx(0.012)
    found, wanted = after.states[effect.name], expected.states[effect.name]
    assert score(found.mean(), wanted.mean(), np.sqrt(wanted.mean() / COLUMNS)) < 5
    assert score(found.var(), wanted.mean(), wanted.mean() * np.sqrt(2.5 / COLUMNS)) < 5


def test_memory_is_one_array_per_effect_and_none_without() -> None:
    effects = (Lag(), Persistence(), RtsPixels(), DuplicatedLines())
    model, left = plain(*effects, columns=20), None
    for k in range(30):
        left = model.draw(at(2, 1.0 * k, left), np.random.default_rng(k)).left
    assert left is not None
    assert {n: s.shape for n, s in left.states.items()} == {e.name: (20,) for e in effects}
    assert model.remembers
    assert not plain().remembers
    assert plain(columns=20).draw(at(2), np.random.default_rng(1)).left is None


def test_a_telegraph_has_its_levels_its_share_and_its_dwell_times_across_draws() -> None:
    up_s, down_s, jump = 4e-4, 8e-4, 50.0
    rts = RtsPixels(amplitude_dn=jump, share=1.0, dwell_up_s=up_s, dwell_down_s=down_s)
    rng, left, levels = np.random.default_rng(11), None, []
    for k in range(300):
        here = at(2, 2 * k * PERIOD_US * 1e-6, None if k == 0 else Left(0.0, {}, drawn=True))
        if left is not None:
            here = replace(here, before=Left(here.line_times_s[0], {rts.name: left}, drawn=True))
        out, left = rts.carry(np.zeros((2, 3000)), here, rng)
        levels.append(out)
    plane = np.concatenate(levels)
    assert np.array_equal(np.unique(plane), [0.0, jump])
    u, rate = 1 / 3, 1 / up_s + 1 / down_s
    per_line = np.exp(-rate * PERIOD_US * 1e-6)
    variance = jump**2 * u * (1 - u)
    effective = plane.size * (1 - per_line) / (1 + per_line)
    assert score(plane.mean(), jump * u, np.sqrt(variance / effective)) < 5
    centred = plane - jump * u
    for d in (1, 3):
        found = np.mean(centred[:-d] * centred[d:])
        assert score(found, variance * per_line**d, jump**2 / 4 / np.sqrt(effective)) < 5, d
    ups = np.diff(plane, axis=0) > 0
    began_down = plane[:-1] == 0
    rises = u * (1 - per_line)
    spread = np.sqrt(rises * (1 - rises) / began_down.sum())
    assert score(ups.sum() / began_down.sum(), rises, spread) < 5


def test_a_telegraph_forgets_during_a_pause_as_long_as_it_dwells() -> None:
    rts, n = RtsPixels(share=1.0, dwell_up_s=0.1, dwell_down_s=0.1), 40_000
    up = np.ones(n)
    for pause_s in (0.0, 0.05):
        here = at(1, 7.0 + pause_s, Left(7.0, {rts.name: up}, drawn=True))
        _, left = rts.carry(np.zeros((1, n)), here, np.random.default_rng(3))
        stays = 0.5 + 0.5 * np.exp(-20.0 * (pause_s + PERIOD_US * 1e-6))
        assert score(left.mean(), stays, np.sqrt(stays * (1 - stays) / n)) < 5


@pytest.mark.parametrize("sample", [(300,), (20, 15)], ids=["line", "frame"])
def test_only_the_chosen_pixels_jump_and_another_sensor_has_others(sample: tuple[int, ...]) -> None:
    def moved(seed: int) -> NDArray[np.bool_]:
        rts = RtsPixels(amplitude_dn=9.0, share=0.031, pattern_seed=seed)
        return rts.apply(np.zeros((200, *sample)), at(200), np.random.default_rng(1)).any(0)

    assert moved(1).sum() == 10
    assert np.array_equal(moved(1), moved(1))
    assert not np.array_equal(moved(1), moved(2))


@seeds
@pytest.mark.parametrize("frame_lines", [1, 50])
def test_duplicates_come_as_often_as_said_whatever_the_frames(seed: int, frame_lines: int) -> None:
    p, n = 0.2, 400
    model = plain(DuplicatedLines(probability=p), columns=64)
    recording = taken(model, [block("0", 1, lines=n), block("1", 1, lines=n)], seed,
                      frame_lines=frame_lines)  # fmt: skip
    for dn in recording.values():
        assert len(dn) == n
        twice = sum(np.array_equal(a, b) for a, b in pairwise(dn))
        assert score(twice, p * (n - 1), np.sqrt(n * p * (1 - p))) < 5
    assert not np.array_equal(recording["0"][-1], recording["1"][0])


def test_a_line_is_not_sent_again_after_a_pause_or_where_none_was_drawn() -> None:
    twice, before = DuplicatedLines(probability=0.9), np.full(8, 5.0)
    for at_s, drawn, again in ((2.0, True, True), (1.9999, True, False), (2.0, False, False)):
        here = at(1, 2.0, Left(at_s, {twice.name: before}, drawn=drawn))
        sent = [twice.apply(np.zeros((1, 8)), here, np.random.default_rng(k)) for k in range(40)]
        assert any(line.any() for line in sent) == again


def test_a_frame_of_an_area_sensor_is_sent_twice_as_a_whole() -> None:
    frames = np.random.default_rng(1).integers(0, 4000, (300, 5, 6)).astype(float)
    sent = DuplicatedLines(probability=0.3).apply(frames, at(300), np.random.default_rng(2))
    source = [np.flatnonzero((frames == one).all((1, 2)))[0] for one in sent]
    assert all(s in {k, source[max(k - 1, 0)]} for k, s in enumerate(source))
    assert score(sum(s != k for k, s in enumerate(source)), 90, np.sqrt(63.0)) < 5


@pytest.fixture
def world(tmp_path: Path) -> Iterator[World]:
    world = World.create(tmp_path / "world", simulated_camera.N_LAMPS)
    yield world
    world.close()


@pytest.mark.parametrize("bench", [simulated_camera, simulated_area_camera], ids=["line", "area"])
def test_a_simulated_camera_remembers_the_frame_before_and_after_new_settings(
    world: World, bench: Any
) -> None:
    f = 0.25
    is_area = bench is simulated_area_camera
    base: Model = simulated_area_camera.AREA if is_area else simulated_camera.MODEL
    camera = MockCamera(base.with_effect(Lag(share=f)), world, seed=3, paced=False)
    for lamp in range(simulated_camera.N_LAMPS):
        world.drive(lamp, 1.0)
    camera.configure(bench.SETTINGS)
    whole(camera.frames(12))
    world.cap(capped=True)
    camera.configure(replace(bench.SETTINGS, exposure_us=20.0))
    frames = [frame.dn.astype(float) for frame in whole(camera.frames(2))]
    after = frames if is_area else [frames[0][0], frames[0][1]]
    truth = base.truth()
    lit = sum(simulated_camera.RADIANCE) * 60.0 * truth.vignette * truth.responsivity
    gain, read_e = 0.2, 10.0
    for k, dn in enumerate(after):
        wanted = truth.dark_offset_dn + f ** (k + 1) * lit
        std = np.sqrt(gain * f ** (k + 1) * lit.mean() + (gain * read_e) ** 2 + 1 / 12)
        assert score(dn.mean(), wanted.mean(), std / np.sqrt(dn.size)) < 5
