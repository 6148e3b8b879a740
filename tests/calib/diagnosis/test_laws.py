import numpy as np
from numpy.random import default_rng
from numpy.typing import NDArray
from scipy.stats import chi2

from calib.diagnosis.naming.courses import chosen
from calib.diagnosis.naming.laws import MOST, Laws, functions

N = 12
TIMES = np.linspace(0.0, 30.0, N)
COURSES = Laws((), functions(TIMES, course=True, smooth=False), MOST)


def found_in(along: NDArray[np.float64]) -> list[NDArray[np.float64]]:
    """Return the functions that are chosen where every block is told to one standard deviation."""
    return chosen(COURSES, np.eye(N), np.eye(N), along)


def test_a_step_is_told_first_and_a_swing_by_few_functions() -> None:
    rng = default_rng()
    step = np.where(TIMES[4] < TIMES, 1.0, -1.0)
    first, *_ = found_in(20.0 * step + rng.standard_normal(N))
    np.testing.assert_array_equal(first, step)
    swing = 20.0 * np.sin(2.0 * np.pi * TIMES / TIMES[-1] * 1.7 + 0.4)
    taken = found_in(swing + rng.standard_normal(N))
    design = np.stack(taken, axis=1)
    left = swing - design @ np.linalg.lstsq(design, swing, rcond=None)[0]
    # Half turns of a grid leave little of what swings in between.
    assert 1 < len(taken) <= MOST
    assert left @ left < 0.05 * swing @ swing


def test_chance_seldom_follows_a_law() -> None:
    rng, runs = default_rng(), 300
    wrong = sum(bool(found_in(rng.standard_normal(N))) for _ in range(runs))
    # Of some thirty functions, each by chance worth 12 in one of 1,900 runs.
    most = 0.02 * runs
    assert len(COURSES.functions) * chi2.sf(12.0, 1) < 0.02
    assert wrong < most + 5.0 * np.sqrt(most)


def test_laws_of_few_values_take_few_functions() -> None:
    assert len(functions(np.array([3.0]), course=False, smooth=False)) == 0
    two = functions(np.array([1.0, 2.0]), course=False, smooth=False)
    assert np.linalg.matrix_rank(two) == 1
