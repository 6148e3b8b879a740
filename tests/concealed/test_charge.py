"""Charge that is moved: conserved, and with the covariances that follow from the rule."""

import numpy as np
import pytest

from tests.concealed.bench import drawn, level_sensor, scan_of
from tests.concealed.generator.mechanism import Mechanism
from tests.concealed.generator.mechanisms.collection import (
    BrighterFatter,
    CosmicRays,
    SaturationKnee,
    reflected_shift,
)
from tests.concealed.generator.mechanisms.transfer import Cti, Lag, Persistence
from tests.concealed.generator.scan import Memory

N = 4000
LIGHT_E = 10_000.0


def covariance(first: np.ndarray, second: np.ndarray) -> tuple[float, float]:
    """Return the covariance over samples, pooled over pixels, and its standard error."""
    a, b = (x - x.mean(axis=0) for x in (first.astype(float), second.astype(float)))
    product = a * b * len(a) / (len(a) - 1)
    return float(product.mean()), float(product.std() / np.sqrt(product.size))


def through(mechanism: Mechanism, counts: np.ndarray, seed: int = 3) -> np.ndarray:
    scan = scan_of(level_sensor(*counts.shape[1:]), len(counts))
    return np.asarray(mechanism.act(counts, scan, {}, np.random.default_rng(seed)))


def poisson(seed: int, rows: int = 1, columns: int = 64) -> np.ndarray:
    return np.random.default_rng(seed).poisson(LIGHT_E, (N, rows, columns))


def test_a_shift_within_the_sensor_loses_nothing() -> None:
    counts = np.random.default_rng(0).integers(0, 9, (5, 4, 7))
    for axis, way in ((1, 1), (1, -1), (2, 2), (2, -2)):
        assert reflected_shift(counts, axis, way).sum() == counts.sum()


def predicted_covariance(a: float, n_steps: int, columns: int = 64) -> np.ndarray:
    """Return the covariance that the rule of one step makes: exact, since it is linear.

    Of Poisson arrivals that part each part is Poisson, so that after a step of mean m
    C' = (1 + m s B) C (1 + m s B)^T + m, B the second difference with borders that reflect.
    """
    second = -2 * np.eye(columns) + np.eye(columns, k=1) + np.eye(columns, k=-1)
    second[0, 0] = second[-1, -1] = -1
    mean, chance = LIGHT_E / n_steps, a * n_steps / (n_steps - 1)
    step, found = np.eye(columns) + mean * chance * second, np.zeros((columns, columns))
    for _ in range(n_steps):
        found = step @ found @ step.T + mean * np.eye(columns)
    return found


@pytest.mark.parametrize("n_steps", [12, 40])
def test_the_steps_make_the_covariance_of_continuous_repulsion(n_steps: int) -> None:
    """dC/dmu = 1 + a (B C + C B): to first order C01 = a mu^2 and V = mu - 2 a mu^2."""
    a, middle = 1e-8, 32
    found = predicted_covariance(a, n_steps)
    assert found[middle, middle + 1] == pytest.approx(a * LIGHT_E**2, rel=1e-3)
    assert LIGHT_E - found[middle, middle] == pytest.approx(2 * a * LIGHT_E**2, rel=1e-3)


@pytest.mark.parametrize("seed", [1, 2])
def test_brighter_fatter_moves_variance_into_covariance(seed: int) -> None:
    a, sensor, middle = 2e-5, level_sensor(), 32
    scan, one = scan_of(sensor, N), BrighterFatter(2e-5, "plain")
    counts = one.act(np.full(scan.shape, LIGHT_E), scan, {}, np.random.default_rng(seed))
    inner = np.asarray(counts)[..., 8:-8]
    expected = predicted_covariance(a, one.n_steps)[middle, middle:]
    for lag in (0, 1, 2):
        found, error = covariance(inner[..., lag:], inner[..., : inner.shape[-1] - lag])
        assert abs(found - expected[lag]) < 4 * error
    assert abs(inner.mean() - LIGHT_E) < 4 * np.sqrt(LIGHT_E / inner.size)


@pytest.mark.parametrize("shape", ["plain", "far_reaching", "one_sided"])
def test_brighter_fatter_loses_no_electron(shape: str) -> None:
    arrived = np.random.default_rng(4).poisson(100.0, (20, 6, 30))
    bf = BrighterFatter(1e-5, shape)
    moved = bf._moved(arrived, np.full(arrived.shape, 0.05), np.random.default_rng(5))
    assert moved.sum() == arrived.sum()
    assert not np.array_equal(moved, arrived)


def test_the_knee_takes_the_square_of_what_is_above_it() -> None:
    knee = SaturationKnee(0.4, "linear", np.full((1, 64), 8000.0), 12_000.0)
    full = np.full((N, 1, 64), 11_000)
    lost = full - through(knee, full)
    share = 0.4 * 3000 / 4000
    spread = np.sqrt(3000 * share * (1 - share) / lost.size)
    assert abs(lost.mean() - 3000 * share) < 4 * spread
    below = np.full((3, 1, 64), 7999)
    np.testing.assert_array_equal(through(knee, below), below)


def test_cosmic_rays_only_add_and_as_much_as_their_number_says() -> None:
    rays = CosmicRays(500.0, "short", 1e-4)
    added = through(rays, np.zeros((N, 1, 64), dtype=np.int64))
    expected = 500.0 * 1e-4 * added.size
    spread = 500.0 * np.sqrt(2.0 * 1e-4 * added.size)  # an exponential's square has mean 2
    assert abs(added.sum() - expected) < 4 * spread
    assert added.min() == 0


@pytest.mark.parametrize("shape", ["each_electron", "incomplete_reset", "small_charge", "barrier"])
def test_lag_keeps_the_charge_and_leaves_the_rest_for_the_next_block(shape: str) -> None:
    sensor, memory = level_sensor(), Memory()
    lag, counts = drawn(Lag, 0.05, shape, sensor), poisson(6)[:50]
    read = lag.act(counts, scan_of(sensor, 50), memory, np.random.default_rng(7))
    assert read.sum() + memory["lag"].sum() == counts.sum()
    dark = lag.act(np.zeros_like(counts), scan_of(sensor, 50), memory, np.random.default_rng(8))
    assert read.sum() + dark.sum() + memory["lag"].sum() == counts.sum()


def test_lag_of_single_electrons_leaves_lines_independent_and_that_of_a_reset_does_not() -> None:
    """Poisson counts that are thinned stay Poisson; a fixed share f of them correlates by f."""
    f, sensor = 0.05, level_sensor()
    for shape, correlation in (("each_electron", 0.0), ("incomplete_reset", f)):
        read = through(drawn(Lag, f, shape, sensor), poisson(9))[20:]
        variance, _ = covariance(read, read)
        found, error = covariance(read[1:], read[:-1])
        assert abs(found / variance - correlation) < 4 * error / variance
        reduced = 1.0 if correlation == 0 else (1 - f) / (1 + f)
        assert abs(variance / LIGHT_E - reduced) < 4 * np.sqrt(2 / read.size)


def test_a_pixel_lagging_behind_a_step_is_short_of_its_share() -> None:
    read = through(drawn(Lag, 0.1, "each_electron", level_sensor()), poisson(10)[:3])
    for line, expected in enumerate((0.9, 0.99, 0.999)):
        assert abs(read[line].mean() / LIGHT_E - expected) < 4 / np.sqrt(LIGHT_E * 64)


def test_traps_let_go_in_the_dark_what_they_caught_in_the_light() -> None:
    sensor, memory, rng = level_sensor(), Memory(), np.random.default_rng(11)
    traps = Persistence(2000.0, "one_time", 0.05, 5.0 * LIGHT_E)
    lit = poisson(12)[:200]
    read = traps.act(lit, scan_of(sensor, 200), memory, rng)
    held = memory["persistence"]["filled"].sum()
    assert read.sum() + held == lit.sum()
    started_s = 200 * 1.2e-3
    before = memory["persistence"]["filled"].copy()
    dark = traps.act(np.zeros_like(lit), scan_of(sensor, 200, started_s=started_s), memory, rng)
    # Line 0 follows at once and gives nothing up; of the others the last is 199 periods later.
    per_line = dark.mean(axis=(1, 2))
    step = np.exp(-1.2e-3 / 0.05)
    expected = before.mean() * (1 - step) * step ** np.arange(199)
    spread = np.sqrt(expected.sum() / 64)
    assert abs(per_line[1:].sum() - expected.sum()) < 4 * spread


def test_traps_that_a_pause_has_emptied_catch_as_at_first() -> None:
    sensor, memory, rng = level_sensor(), Memory(), np.random.default_rng(12)
    traps = Persistence(2000.0, "one_time", 0.05, 5.0 * LIGHT_E)
    caught = []
    for started_s in (0.0, 10.0):
        lit = poisson(13)[:200]
        read = traps.act(lit, scan_of(sensor, 200, started_s=started_s), memory, rng)
        caught.append(float((lit[0] - read[0]).mean()))
    # Of 2,000 traps with the chance 1 - exp(-1/5), in each of 64 pixels.
    chance = 1.0 - np.exp(-0.2)
    spread = np.sqrt(2.0 * 2000.0 * (chance + chance**2) / 64)
    assert abs(caught[1] - caught[0]) < 4.0 * spread
    assert min(caught) > 10.0 * spread


@pytest.mark.parametrize("shape", [*Cti.shapes, *Cti.foreign])
def test_transfers_lose_charge_only_behind_the_last_packet(shape: str) -> None:
    sensor = level_sensor()
    cti = drawn(Cti, 1e-4, shape, sensor)
    edge = np.zeros((500, 1, 64), dtype=np.int64)
    edge[..., 10:30] = 10_000
    moved = through(cti, edge)
    assert moved.sum() == edge.sum()
    assert moved[..., :10].sum() == 0
    assert moved[..., 30].mean() > 0


def test_a_constant_share_is_left_behind_once_per_transfer() -> None:
    share, point = 1e-4, np.zeros((N, 1, 64), dtype=np.int64)
    point[..., 40] = 10_000
    moved = through(drawn(Cti, share, "constant", level_sensor()), point)
    stays = (1 - share) ** 41
    spread = np.sqrt(10_000 * stays * (1 - stays) / N)
    assert abs(moved[..., 40].mean() - 10_000 * stays) < 4 * spread
