"""K and the read noise lie as far from the truth as their standard errors say."""

import numpy as np
import pytest

from tests.calib.transfer.photon_transfer.coverage import KINDS, scores
from tests.calib.transfer.photon_transfer.simulated import Kind

FEW, MANY = 16, 400


def assert_covers(kind: Kind, lines: int, seeds: range, most_off: float) -> None:
    z, _ = scores(kind, lines, seeds)
    n = len(z)
    for of in range(3):
        assert abs(z[:, of].mean()) < 4 / np.sqrt(n), (kind, lines, of)
        assert abs(z[:, of].std(ddof=1) - 1) < most_off + 4 / np.sqrt(2 * n), (kind, lines, of)


@pytest.mark.parametrize("kind", KINDS)
def test_errors_are_as_large_as_stated(kind: Kind) -> None:
    assert_covers(kind, 20, range(FEW), most_off=0.1)


@pytest.mark.soak
@pytest.mark.parametrize("lines", [20, 100, 500])
@pytest.mark.parametrize("kind", KINDS)
def test_errors_are_as_large_as_stated_over_many_recordings(kind: Kind, lines: int) -> None:
    # 1 ± 0.1 is the promise; four standard errors of a spread from 400 recordings are 0.14.
    assert_covers(kind, lines, range(1000, 1000 + MANY), most_off=0.0)
