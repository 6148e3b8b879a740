"""Derivatives and their inner products, against finite differences and sums over all pixels."""

import numpy as np
import pytest
from numpy.random import default_rng
from numpy.typing import NDArray

from calib.mtf.estimation.normal_equations import normal_matrix
from calib.mtf.estimation.slopes import Slopes
from calib.mtf.estimation.state import State
from calib.mtf.geometry import Alignment, Sampling, Scan
from tests.calib.mtf.simulated import ORDERS_12

STEP = 1e-6
ROUND_OFF = 1e-6  # of a column's length: differences of numbers of order 100 over 2e-6


@pytest.fixture(scope="module")
def state() -> State:
    rng, scan = default_rng(), Scan(25.0, 1, 2)
    harmonics = ORDERS_12.harmonics
    alignment = Alignment(rng.uniform(-9, 9, 2), 1e-3, 2e-3, rng.normal(scale=0.1, size=(5, 2)))
    amplitude = rng.normal(scale=5, size=(2, len(harmonics))) * [[1], [1j]]
    return State(
        harmonics,
        Sampling.whole(scan, (9, 11), alignment),
        np.concatenate([[50 + 0j], amplitude.sum(0)]),
        1 + rng.normal(scale=0.01, size=5),
        np.ones(5, bool),
    )


@pytest.fixture(scope="module")
def differences(state: State) -> NDArray[np.floating]:
    """Derivatives of all pixels by each unknown, (n_unknowns, n_pixels)."""
    columns = []
    for index in range(state.layout.size):
        step = np.zeros(state.layout.size)
        step[index] = STEP
        change = Slopes(state.moved(step)).model - Slopes(state.moved(-step)).model
        columns.append(change.ravel() / (2 * STEP))
    return np.array(columns)


def test_the_normal_matrix_holds_the_derivatives_inner_products(
    state: State, differences: NDArray[np.floating]
) -> None:
    expected = differences @ differences.T
    size = np.sqrt(np.multiply.outer(np.diag(expected), np.diag(expected)))
    assert np.abs((normal_matrix(state) - expected) / size).max() < ROUND_OFF


def test_gradients_are_sums_over_pixels_of_derivatives(
    state: State, differences: NDArray[np.floating]
) -> None:
    slopes = Slopes(state)
    residual = default_rng().normal(size=slopes.model.shape)
    total = slopes.total(residual)
    size = np.linalg.norm(differences, axis=1) * np.linalg.norm(residual)
    assert np.abs((total - differences @ residual.ravel()) / size).max() < ROUND_OFF
    parts = [slopes.by_pixel(residual[:, rows], rows) for rows in (slice(0, 4), slice(4, 9))]
    away = np.hstack(parts).sum(1, dtype=np.float64) - total
    assert np.abs(away / size).max() < 4 * np.finfo(np.float32).eps  # they are in single precision
