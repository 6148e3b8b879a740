"""What blocks share as a whole is found from the darks, however few they are."""

import numpy as np
import pytest

from calib.radiometric.estimation.block_noise import BlockNoise, block_noise
from calib.radiometric.estimation.clear_darks import ClearDarks

N_COLUMNS = 200


def darks(exposure_us: list[float], offset_dn: float, rng: np.random.Generator) -> ClearDarks:
    """Darks of a noise of 0.2 DN each and a dark current of 0.01 DN/µs."""
    times = np.array(exposure_us)
    shape = (len(times), N_COLUMNS)
    mean = 60.0 + 0.01 * times[:, None] + offset_dn * rng.standard_normal((len(times), 1))
    own = np.full(shape, 0.04)
    clear = np.ones(N_COLUMNS, np.bool_)
    return ClearDarks(times, mean + 0.2 * rng.standard_normal(shape), own, clear)


@pytest.mark.parametrize(
    ("exposure_us", "freedom"),
    [([100.0, 200.0, 300.0, 400.0, 500.0], 3), ([100.0] * 4, 3), ([100.0, 500.0] * 3, 4)],
    ids=["all-different", "one-exposure", "repeated"],
)
def test_it_is_found_without_repeated_exposures(exposure_us: list[float], freedom: int) -> None:
    rng = np.random.default_rng()
    found = [block_noise(darks(exposure_us, 0.3, rng), 1.0) for _ in range(2000)]
    assert {f.freedom for f in found} == {freedom}
    square = np.array([f.found_dn2 for f in found])
    assert abs(square.mean() - 0.09) < 4 * square.std() / np.sqrt(2000)


def test_none_is_found_where_there_is_none() -> None:
    rng, times = np.random.default_rng(), [100.0, 200.0, 300.0, 400.0, 500.0]
    found = [block_noise(darks(times, 0.0, rng), 1.0).found_dn2 for _ in range(500)]
    own = 0.04 / N_COLUMNS
    assert np.mean(np.array(found) > 0) < 0.5  # chi-squared lies below its mean more often
    assert np.mean(found) < own


def test_where_nothing_tells_it_is_up_to_the_temporal_noise() -> None:
    rng = np.random.default_rng()
    for times in ([100.0], [100.0, 500.0]):
        found = block_noise(darks(times, 0.3, rng), 0.12)
        assert found.freedom == 0
        assert found.variance_dn2 == pytest.approx(0.04)


def test_few_darks_widen_it_up_to_the_temporal_noise() -> None:
    assert BlockNoise(0.01, 3, 1.0).variance_dn2 == pytest.approx(0.03)
    assert BlockNoise(0.5, 3, 1.0).variance_dn2 == 1.0
    assert BlockNoise(2.0, 3, 1.0).variance_dn2 == pytest.approx(6.0)
