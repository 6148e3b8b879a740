"""Charge that repels charge leaves the covariances of shifting boundaries."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from calib.forward.effects.brighter_fatter import BrighterFatter
from calib.forward.model import Model
from tests.calib.forward.small_sensors import at, sensors

RNG = np.random.default_rng(0)
SEEDS = pytest.mark.parametrize("seed", [1, 2, 3])


def covariances(charge: NDArray[np.float64], mean: float, lags: list[tuple[int, ...]]) -> Any:
    """Mean product of deviations at each lag, pixels near the edges left out."""
    inner = charge.shape[1] - 4, charge.shape[-1] - 4
    off = charge - mean

    def part(shift: tuple[int, ...]) -> NDArray[np.float64]:
        cut = (slice(None),)
        for n, by in zip(inner[-len(shift) :], shift, strict=True):
            cut += (slice(2 + by, 2 + by + n),)
        return off[cut]

    zero = part((0,) * (charge.ndim - 1))
    return np.array([np.mean(zero * part(lag)) for lag in lags])


@SEEDS
@pytest.mark.parametrize("kind", ["line", "frame"])
def test_brighter_fatter_leaves_the_covariances_of_shifting_boundaries(
    kind: str, seed: int
) -> None:
    """Antilogus: half of a pixel's last charge moves its boundaries, by a on each side.

    About the mean mu a pixel so loses mu a / 2 (d - d') to each neighbour, d and d' being what
    they hold beyond mu; Poisson charge filtered by that kernel has its autocorrelation.
    """
    mean, row, column, corner = 20_000.0, 2e-6, 3e-6, 1e-6
    sample = (1500,) if kind == "line" else (40, 40)
    charge = np.random.default_rng(seed).poisson(mean, (500, *sample)).astype(np.float64)
    effect = BrighterFatter(row_per_e=row, column_per_e=column, corner_per_e=corner)
    moved = effect.apply(charge, at(500), RNG)
    if kind == "line":
        kernel = np.zeros((1, 7))
        kernel[0, 2:5] = np.array([row, -2 * row, row]) * mean / 2
        kernel[0, 3] += 1
        lags: list[tuple[int, ...]] = [(0,), (1,), (2,)]
        wanted = [(kernel[0, : 7 - k] * kernel[0, k:]).sum() for (k,) in lags]
    else:
        kernel = np.zeros((7, 7))
        sides = np.array([[corner, column, corner], [row, 0, row], [corner, column, corner]])
        kernel[2:5, 2:5] = sides * mean / 2
        kernel[3, 3] = 1 - sides.sum() * mean / 2
        lags = [(0, 0), (0, 1), (1, 0), (1, 1), (1, -1), (0, 2), (2, 0)]
        wanted = [(kernel * np.roll(kernel, (-i, -j), (0, 1))).sum() for i, j in lags]
    n = charge.size * (1 if kind == "line" else 0.81)
    error = np.where(np.arange(len(lags)) == 0, np.sqrt(2.0), 1.0) / np.sqrt(n)
    got = covariances(moved, mean, lags) / mean
    assert np.all(np.abs(got - np.array(wanted)) < 5 * error), (got, wanted)


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
    # The second moment gains 2 x (what crosses each boundary) x (its distance from the centre).
    q = 50_000 * row
    crossing = 1e-6 / 4 * (q[20:-1] ** 2 - q[21:] ** 2)
    gained = 2 * (crossing * (2 * np.arange(20) + 1)).sum() / q.sum()
    assert width(50_000.0) == pytest.approx(1.6**2 + gained, rel=1e-6)
