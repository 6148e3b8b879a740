"""Charge that repels charge leaves the covariances of shifting boundaries."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from calib.forward.effects.brighter_fatter import BrighterFatter
from calib.forward.model import Model
from tests.calib.forward.small_sensors import at, sensors

RNG = np.random.default_rng(0)
EDGE = 6
SEEDS = pytest.mark.parametrize("seed", [1, 2, 3])


def covariances(charge: NDArray[np.float64], mean: float, lags: list[tuple[int, ...]]) -> Any:
    """Mean product of deviations at each lag, pixels near the edges left out."""
    inner = charge.shape[1] - 2 * EDGE, charge.shape[-1] - 2 * EDGE
    off = charge - mean

    def part(shift: tuple[int, ...]) -> NDArray[np.float64]:
        cut = (slice(None),)
        for n, by in zip(inner[-len(shift) :], shift, strict=True):
            cut += (slice(EDGE + by, EDGE + by + n),)
        return off[cut]

    zero = part((0,) * (charge.ndim - 1))
    return np.array([np.mean(zero * part(lag)) for lag in lags])


@SEEDS
@pytest.mark.parametrize("times", [1.0, 8.0])
@pytest.mark.parametrize("kind", ["line", "frame"])
def test_brighter_fatter_leaves_the_covariances_of_shifting_boundaries(
    kind: str, times: float, seed: int
) -> None:
    """Astier et al., Equation 20: charge that repels while it gathers.

    Of a spatial frequency the first order takes y mu, y = mu sum of a (1 - cos k), and all orders
    together leave mu (1 - exp(-2 y)) / (2 y). The effect does to 1e-4 of what is left, for y of up
    to 4; here it is at most 3.2 in a frame.
    """
    mean, row, column, corner = 20_000.0, times * 2e-6, times * 3e-6, times * 1e-6
    sample = (1500,) if kind == "line" else (40, 40)
    charge = np.random.default_rng(seed).poisson(mean, (500, *sample)).astype(np.float64)
    effect = BrighterFatter(row_per_e=row, column_per_e=column, corner_per_e=corner)
    moved = effect.apply(charge, at(500), RNG)
    k = 2 * np.pi * np.fft.fftfreq(64)
    along, down = np.cos(k)[np.newaxis, :], np.cos(k)[:, np.newaxis]
    y = 2 * row * mean * (1 - along)
    lags: list[tuple[int, ...]] = [(0,), (1,), (2,)]
    if kind == "frame":
        y = y + 2 * column * mean * (1 - down) + 4 * corner * mean * (1 - along * down)
        lags = [(0, 0), (0, 1), (1, 0), (1, 1), (1, -1), (0, 2), (2, 0)]
    left = -np.expm1(-2 * y) / np.where(y > 0, 2 * y, 1.0) + (y == 0)
    every = np.fft.ifft2(np.broadcast_to(left, (64, 64) if kind == "frame" else (1, 64))).real
    wanted = [every[lag if kind == "frame" else (0, *lag)] for lag in lags]
    n = charge.size * (1 if kind == "line" else (1 - 2 * EDGE / 40) ** 2)
    error = np.where(np.arange(len(lags)) == 0, np.sqrt(2.0), 1.0) / np.sqrt(n)
    got = covariances(moved, mean, lags) / mean
    assert y.max() < 4.0
    # Pixels that covary are fewer independent ones: what is left of the squares says how many.
    error = error * np.sqrt((left**2).mean())
    assert np.all(np.abs(got - np.array(wanted)) < 5 * error + 2e-4), (got, wanted)


def test_brighter_fatter_beyond_all_sensors_stays_a_number() -> None:
    charge = np.random.default_rng(1).uniform(0, 30_000, (20, 12, 16))
    moved = BrighterFatter(row_per_e=1e-2, column_per_e=1e-2).apply(charge, at(20), RNG)
    assert moved.min() >= 0.0
    assert moved.max() <= 2.0 * charge.max()


@sensors
def test_brighter_fatter_moves_charge_and_loses_none(model: Model) -> None:
    sample = model.truth().vignette.shape
    charge = np.random.default_rng(1).uniform(0, 30_000, (20, *sample))
    moved = BrighterFatter(row_per_e=1e-6).apply(charge, at(20), RNG)
    axes = tuple(range(1, charge.ndim))
    assert np.allclose(moved.sum(axis=axes), charge.sum(axis=axes), rtol=1e-13)
    assert np.abs(moved - charge).max() > 10


def test_brighter_fatter_widens_a_bright_spot_and_hardly_a_faint_one() -> None:
    row = np.exp(-((np.arange(41) - 20.0) ** 2) / (2 * 1.6**2))
    effect = BrighterFatter(row_per_e=1e-6)

    def width(peak: float) -> float:
        seen = effect.apply(peak * row[np.newaxis], at(1), RNG)[0]
        return float((seen * (np.arange(41) - 20.0) ** 2).sum() / seen.sum())

    assert width(100.0) == pytest.approx(1.6**2, rel=2e-3)
    # The second moment gains 2 x (what crosses each boundary) x (its distance from the centre);
    # of a width of 1.6 pixels, what was moved moves less in the next order, by a mu / (2 x 1.6^2).
    q = 50_000 * row
    crossing = 1e-6 / 4 * (q[20:-1] ** 2 - q[21:] ** 2)
    gained = 2 * (crossing * (2 * np.arange(20) + 1)).sum() / q.sum()
    assert width(50_000.0) - 1.6**2 == pytest.approx(gained, rel=50_000 * 1e-6 / 1.6**2)
