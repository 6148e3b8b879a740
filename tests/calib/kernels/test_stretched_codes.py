import numpy as np
import pytest
from numpy.typing import NDArray

from calib.kernels.stretched_codes import stretched_codes

Floats = NDArray[np.float64]


def twin(signal: Floats, edges: Floats) -> Floats:
    code = np.clip(np.searchsorted(edges, signal, side="right") - 1, 0, len(edges) - 2)
    low, high = edges[code], edges[code + 1]
    return np.asarray(code - 0.5 + (signal - low) / np.where(high > low, high - low, 1.0))


@pytest.mark.parametrize("most", [0.3, 3.0, 300.0])
def test_codes_are_those_of_plain_numpy_however_far_their_edges_have_moved(most: float) -> None:
    rng = np.random.default_rng()
    widths = rng.exponential(1.0, 1024) ** most
    widths[rng.integers(0, 1024, 200)] = 0.0
    edges = np.concatenate([[0.0], np.cumsum(widths)]) * (1024 / widths.sum()) - 0.5
    signal = np.concatenate([rng.uniform(-20.0, 1044.0, 4000), edges, edges - 1e-9])
    signal = signal[: len(signal) // 6 * 6].reshape(-1, 2, 3)
    assert np.array_equal(stretched_codes(signal, edges), twin(signal, edges))
