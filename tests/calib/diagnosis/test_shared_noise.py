"""Statistics of common noise scatter as stated, and tell a shared variance once."""

import numpy as np
import pytest
from numpy.random import default_rng
from numpy.typing import NDArray

from calib.diagnosis.evidence.shared_noise import SharedNoise
from calib.diagnosis.recorded.sensor import Sensor
from calib.diagnosis.statistics.counts import Counts
from calib.recording.header import CameraHeader

LINES, BLOCKS = 60, 3000


def counts(rows: int) -> Counts:
    camera = CameraHeader(
        columns=64, bit_depth=12, taps=2, tap_layout="odd_even", rows=rows if rows > 1 else None
    )
    return Counts.of(Sensor(camera))


def drawn(
    rows: int, white: NDArray[np.float64], shared: float, share: float
) -> NDArray[np.float64]:
    """Each block's statistics about their expectation, (BLOCKS, 5), from its taps' means."""
    rng = default_rng()
    frame = rng.normal(size=(BLOCKS, LINES, 1, 1)) * np.sqrt(shared * share)
    row = rng.normal(size=(BLOCKS, LINES, rows, 1)) * np.sqrt(shared * (1 - share))
    own = rng.normal(size=(BLOCKS, LINES, rows, 2)) * np.sqrt(white)
    means = frame + row + own
    off = means - means.mean(axis=1, keepdims=True)
    n = LINES - 1
    found = [(off[..., t] ** 2).sum(axis=(1, 2)) / (n * rows) for t in (0, 1)]
    found.append((off[..., 0] * off[..., 1]).sum(axis=(1, 2)) / (n * rows))
    along = off.mean(axis=-1)
    if rows > 1:
        product = along[:, :, 1:] * along[:, :, :-1]
        found.append(product.sum(axis=(1, 2)) / (n * (rows - 1)))
    whole = along.mean(axis=2)
    lags = (1,) if rows > 1 else (1, 2)
    found += [(whole[:, k:] * whole[:, :-k]).sum(axis=1) / (LINES - k) for k in lags]
    every = np.stack(found, axis=1)
    return np.asarray(every - every.mean(axis=0))


@pytest.mark.parametrize(("rows", "share"), [(1, 0.0), (6, 0.0), (6, 1.0)])
@pytest.mark.parametrize("shared", [0.0, 0.3, 10.0])
def test_common_statistics_scatter_as_stated_and_are_told_once(
    rows: int, share: float, shared: float
) -> None:
    white = np.array([1.0, 1.2])
    noise = SharedNoise(counts(rows), white, shared, share)
    without = drawn(rows, white, 0.0, 0.0).std(axis=0)
    found = drawn(rows, white, shared, share)
    # Standard deviations over 3000 blocks err by 1.3 %, two of them by 1.8 %; rows next to each
    # other are taken to scatter like all, which those at both ends do not: 5 % at most.
    assert np.abs(found.std(axis=0) / without / noise.growth() - 1.0).max() < 4.5 * 0.018 + 0.05
    white_ones = found / found.std(axis=0) @ noise.whitener().T
    # Fisher information of the shared variance: what all statistics tell together scatters as told.
    direction = noise.whitener() @ (np.array([1.0, 1.0, 1.0, share, 0.0]) / found.std(axis=0))
    seen = white_ones @ direction / np.linalg.norm(direction)
    assert seen.std() == pytest.approx(1.0, abs=4.5 * 0.013 + 0.08)
