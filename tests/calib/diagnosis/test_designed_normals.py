import numpy as np
import pytest

from calib.diagnosis.simulation.designed_noise import DesignedNoise
from calib.diagnosis.simulation.designed_normals import (
    NEIGHBOURS,
    WIDTH,
    designed_normals,
    designed_sequences,
)

BLOCKS, COLUMNS = 18, 256
ROUNDING = 1e-12


def blocks(n_lines: int, source: int) -> np.ndarray:
    return np.stack([designed_normals(n_lines, (COLUMNS,), b, source) for b in range(BLOCKS)])


@pytest.mark.parametrize("n_lines", [2, 3, 8, 16])
def test_each_pixel_has_mean_0_and_variance_1(n_lines: int) -> None:
    for source in (0, 1, 4):
        drawn = blocks(n_lines, source)
        assert np.abs(drawn.mean(axis=1)).max() < ROUNDING
        assert np.abs(drawn.var(axis=1, ddof=1) - 1.0).max() < ROUNDING


def test_neighbours_and_sources_are_orthogonal() -> None:
    charge, read = blocks(16, 0), blocks(16, 1)
    assert np.abs((charge * read).mean(axis=1)).max() < ROUNDING
    for lag in range(1, NEIGHBOURS + 1):
        # Pairs within one array; where the next begins, they are independent.
        inside = np.arange(COLUMNS - lag) % WIDTH < WIDTH - lag
        for one, other in ((charge, charge), (read, read), (charge, read), (read, charge)):
            products = (one[..., lag:] * other[..., :-lag]).mean(axis=1)
            assert np.abs(products[:, inside]).max() < ROUNDING


def test_what_is_not_exact_is_nearer_to_its_expectation_than_chance() -> None:
    drawn, n = blocks(16, 0), 16
    fourth = (drawn**4).mean(axis=1).reshape(BLOCKS, 4, -1).mean(axis=2) / 3.0
    # Numbers about their own mean: the fourth moment of normal ones, by chance +- 0.10.
    assert np.abs(fourth - ((n - 1) / n) ** 2).max() < 0.10
    for lag in (1, 2):
        products = (drawn[:, lag:] * drawn[:, :-lag]).sum(axis=1) / (n - lag)
        grouped = products.reshape(BLOCKS, 4, -1).mean(axis=2) + 1.0 / n
        by_chance = 1.0 / np.sqrt((n - lag) * COLUMNS / 4)
        assert np.sqrt((grouped**2).mean()) < 0.25 * by_chance
        assert abs(grouped.mean()) < 0.1 * by_chance


def test_a_sequence_is_white_about_its_own_mean() -> None:
    n = 16
    for which in range(8):
        one = designed_sequences(n, which)[:, 0]
        assert abs(one.mean()) < ROUNDING
        assert abs(one.var(ddof=1) - 1.0) < ROUNDING
        for lag in (1, 2, 3):
            # By chance +- 0.25; the best of a hundred lie within a fifth of that.
            assert abs((one[lag:] * one[:-lag]).mean() + 1.0 / n) < 0.05


@pytest.mark.parametrize("sample", [(64,), (6, 32)])
def test_numbers_of_taps_are_white_and_orthogonal(sample: tuple[int, ...]) -> None:
    n, rng = 16, DesignedNoise([1], (16, *sample), (0,), 2, noise=1.0)
    asked = [(n, *(1 for _ in sample[1:]), 4), (n, *sample[:-1], 4)]
    for drawn in (rng.standard_normal(shape) for shape in asked):
        of_row = drawn.reshape(n, -1)[:, :4]
        assert np.abs(of_row.T @ of_row - (n - 1) * np.eye(4)).max() < n * ROUNDING
    assert not rng.events


def test_counts_get_designed_noise_and_events_chance() -> None:
    shape = (16, 64)
    rng = DesignedNoise([1], shape, (0,), 2, noise=1.0)
    counts = np.stack([rng.binomial(np.full(64, 1000.0), 0.1) for _ in range(16)])
    np.testing.assert_allclose(counts.mean(axis=0), 100.0, atol=1e-9)
    np.testing.assert_allclose(counts.var(axis=0, ddof=1), 90.0, atol=1e-9)
    assert not rng.events
    opposite = DesignedNoise([1], shape, (0,), 2, noise=-1.0)
    np.testing.assert_array_equal(
        DesignedNoise([1], shape, (0,), 2, noise=1.0).standard_normal((16, 1)),
        -opposite.standard_normal((16, 1)),
    )
    rng.random(3)
    assert rng.events
    assert DesignedNoise([1], shape, (0,), 2, noise=0.0).binomial(np.full(64, 9.0), 0.5)[0] == 4.5
