"""The compiled noise has the moments, the distribution and the independence of the real one."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.stats import chi2, poisson

from calib.arrays import RawLines
from calib.errors import InputError
from calib.kernels.noise import draw_codes, exact_range
from tests.calib.kernels import numpy_noise

N_COLUMNS = 1000


def draw(mean: float, read_std: float, n_lines: int, key: int, **changed: Any) -> RawLines:
    """Codes of a uniform scene of N_COLUMNS columns, by default finely resolved 16-bit ones."""
    columns: dict[str, Any] = {"gain": 1.0, "offset": 0.0} | changed
    return draw_codes(
        np.full((1, N_COLUMNS), mean),
        np.ones(n_lines),
        np.zeros(N_COLUMNS),
        read_std_e=read_std,
        gain_dn_per_e=np.full(N_COLUMNS, columns["gain"]),
        offset_dn=np.full(N_COLUMNS, columns["offset"]),
        full_scale_dn=columns.get("full_scale", 65535),
        full_well_e=columns.get("full_well", np.inf),
        key=key,
        first_line=columns.get("first_line", 0),
    )


MOMENTS = {
    "dark, no light": (0.0, 3.0),
    "few electrons, drawn exactly": (0.4, 1.0),
    "few electrons under much read noise": (2.0, 3.0),
    "just drawn exactly": (19.0, 1.0),
    "just smooth": (20.5, 0.8),
    "tens of electrons": (60.0, 2.0),
    "single electrons show": (60.0, 0.3),
    "a thousand electrons": (1000.0, 10.0),
    "near a full well of 100,000": (90_000.0, 30.0),
}


def moment_scores(mean: float, read_std: float, n_samples: int, key: int) -> NDArray[np.float64]:
    """Deviation of the first four moments about the true mean, in standard errors, (4,)."""
    std = np.sqrt(mean + read_std**2)
    gain = 30_000 / (mean + 12 * std)
    offset = 8 * std * gain
    sums, squares = np.zeros(4), np.zeros(4)
    lines = 1000
    for first in range(0, n_samples // N_COLUMNS, lines):
        codes = draw(mean, read_std, lines, key, gain=gain, offset=offset, first_line=first)
        x = (codes.ravel() - offset) / gain - mean
        power = np.ones_like(x)
        for k in range(4):
            power *= x  # x**3 would take far longer
            sums[k] += power.sum()
            squares[k] += power @ power
    v = std**2 + 1 / (12 * gain**2)
    truth = np.array([0.0, v, mean, 3 * v**2 + mean])  # cumulants of a Poisson number: all `mean`
    found = sums / n_samples
    return np.asarray((found - truth) / np.sqrt((squares / n_samples - found**2) / n_samples))


@pytest.mark.parametrize(("mean", "read_std"), MOMENTS.values(), ids=MOMENTS)
def test_first_four_moments_are_true_to_four_standard_errors(mean: float, read_std: float) -> None:
    scores = moment_scores(mean, read_std, 10_000_000, key=int(7 + 100 * mean))
    assert np.all(np.abs(scores) < 4), scores


@pytest.mark.soak
@pytest.mark.parametrize(("mean", "read_std"), MOMENTS.values(), ids=MOMENTS)
def test_first_four_moments_hold_over_a_hundred_million_samples(
    mean: float, read_std: float
) -> None:
    scores = moment_scores(mean, read_std, 100_000_000, key=int(11 + 100 * mean))
    assert np.all(np.abs(scores) < 4), scores


@pytest.mark.parametrize("mean", [0.3, 3.0, 19.0, 29.9, 30.1, 200.0, 5000.0])
def test_without_read_noise_codes_are_poisson_numbers(mean: float) -> None:
    codes = draw(mean, 0.0, 1000, key=int(1000 * mean)).ravel()
    low, high = int(poisson.ppf(1e-5, mean)), int(poisson.ppf(1 - 1e-5, mean))
    found = np.bincount(np.clip(codes, low, high) - low, minlength=high - low + 1)
    chance = poisson.pmf(np.arange(low, high + 1), mean)
    chance[0], chance[-1] = poisson.cdf(low, mean), poisson.sf(high - 1, mean)
    expected = chance * codes.size
    p = chi2.sf(((found - expected) ** 2 / expected).sum(), len(expected) - 1)
    assert 1e-5 < p < 1 - 1e-5


FULL = {
    "well clips": {"mean": 5000.0, "read_std": 10.0, "full_well": 5020.0, "gain": 0.5},
    "deep in the full well": {"mean": 9000.0, "read_std": 5.0, "full_well": 5000.0, "gain": 0.5},
    "converter clips above": {"mean": 5000.0, "read_std": 10.0, "gain": 0.052, "full_scale": 255},
    "converter clips below": {"mean": 0.0, "read_std": 10.0, "gain": 0.2, "offset": -1.0},
    "eight bits, coarse": {"mean": 400.0, "read_std": 50.0, "gain": 0.0035, "full_scale": 255},
    "few electrons, coarse": {"mean": 6.0, "read_std": 1.2, "gain": 1.7, "offset": 3.0},
    "smooth at 25 electrons": {"mean": 25.0, "read_std": 0.8, "gain": 1.0, "offset": 3.0},
}


@pytest.mark.parametrize("case", FULL.values(), ids=FULL)
def test_codes_are_distributed_like_the_physics_drawn_step_by_step(case: dict[str, Any]) -> None:
    of_kernel = draw(n_lines=1000, key=3, **case)
    plain = {"gain": 1.0, "offset": 0.0, "full_scale": 65535, "full_well": np.inf} | case
    twin = numpy_noise.physics(
        of_kernel.shape,
        plain.pop("mean"),
        plain.pop("read_std"),
        rng=np.random.default_rng(8),
        **plain,
    )
    assert numpy_noise.two_sample_p(of_kernel, twin) > 1e-4


def test_smooth_codes_are_those_of_the_same_arithmetic_in_numpy() -> None:
    mean, read_std, gain, key = 300.0, 4.0, 7.0, 0xFEDCBA9876543210
    codes = draw(mean, read_std, 200, key, gain=gain, first_line=70)
    counter = np.arange(70 * N_COLUMNS, 270 * N_COLUMNS, dtype=np.uint64)
    z = numpy_noise.quantile(numpy_noise.triple32(counter, numpy_noise.splitmix64(key)))
    twin = np.floor(numpy_noise.smooth_electrons(z, mean, read_std) * gain + 0.5)
    off = np.abs(codes.ravel().astype(np.float64) - twin)
    # The kernel's quantile is good to 5e-5, 0.006 DN for each standard deviation here.
    assert off.max() <= 1
    assert np.mean(off > 0) < 0.02


def correlation(a: NDArray[Any], b: NDArray[Any]) -> float:
    """Correlation of two fields in standard errors of independent ones."""
    a, b = a.astype(np.float64).ravel(), b.astype(np.float64).ravel()
    return float(np.corrcoef(a, b)[0, 1] * np.sqrt(a.size))


@pytest.mark.parametrize(("mean", "read_std"), [(1000.0, 10.0), (3.0, 1.0)])
@pytest.mark.parametrize("power", [1, 2])
def test_neighbours_frames_and_keys_are_independent(
    mean: float, read_std: float, power: int
) -> None:
    kept = {"gain": 30.0, "offset": 300.0}
    field, following, other = (
        (draw(mean, read_std, 1000, key, first_line=first, **kept) - 300.0 - 30.0 * mean) ** power
        for key, first in ((5, 0), (5, 1000), (6, 0))
    )
    pairs = {
        "columns": (field[:, 1:], field[:, :-1]),
        "next but one column": (field[:, 2:], field[:, :-2]),
        "lines": (field[1:], field[:-1]),
        "sixteen columns": (field[:, 16:], field[:, :-16]),
        "frames": (field, following),
        "keys": (field, other),
        "keys, shifted": (field[:, 1:], other[:, :-1]),
    }
    scores = {name: correlation(a, b) for name, (a, b) in pairs.items()}
    assert max(abs(score) for score in scores.values()) < 4.5, scores


@pytest.mark.parametrize(("mean", "read_std"), [(1000.0, 10.0), (3.0, 1.0)])
def test_codes_do_not_depend_on_how_lines_are_split(mean: float, read_std: float) -> None:
    whole = draw(mean, read_std, 30, key=9)
    split = [draw(mean, read_std, n, key=9, first_line=f) for f, n in ((0, 7), (7, 1), (8, 22))]
    assert np.array_equal(whole, np.vstack(split))
    assert not np.array_equal(whole, draw(mean, read_std, 30, key=10))


def test_more_pixels_than_the_counter_has_are_refused() -> None:
    last = (1 << 32) // N_COLUMNS
    assert draw(5.0, 3.0, 1, key=1, first_line=last - 1).shape == (1, N_COLUMNS)
    with pytest.raises(InputError, match="repeat") as caught:
        draw(5.0, 3.0, 1, key=1, first_line=last)
    assert caught.value.code == "too-many-pixels"


def test_one_line_for_all_gives_the_codes_of_the_full_image() -> None:
    rng = np.random.default_rng(1)
    light, factor = rng.uniform(0, 2000, N_COLUMNS), rng.uniform(0.5, 2.0, 40)
    rest: dict[str, Any] = {
        "dark_e": rng.uniform(0, 50, N_COLUMNS),
        "read_std_e": 2.0,
        "gain_dn_per_e": np.full(N_COLUMNS, 1.0),
        "offset_dn": np.full(N_COLUMNS, 20.0),
        "full_scale_dn": 4095,
        "full_well_e": 3500.0,
        "key": 4,
    }
    row = draw_codes(light[np.newaxis].astype(np.float32), factor, **rest)
    image = light.astype(np.float32) * factor[:, np.newaxis].astype(np.float32)
    full = draw_codes(image, np.ones(40), **rest)
    # A fused multiply-add may differ in the last bit of the mean, and a Poisson number with it.
    assert np.mean(row != full) < 1e-3


EXACT = {
    "little read noise": (0.5, np.inf, (True, True, True)),
    "usual read noise": (2.0, np.inf, (True, False, False)),
    "much read noise": (8.0, np.inf, (False, False, False)),
    "a full well at 1000": (8.0, 1000.0, (False, False, True)),
}


@pytest.mark.parametrize(("read_std", "full_well", "wanted"), EXACT.values(), ids=EXACT)
def test_electrons_are_drawn_exactly_where_the_smooth_form_fails(
    read_std: float, full_well: float, wanted: tuple[bool, ...]
) -> None:
    below, above = exact_range(read_std, full_well)
    assert tuple(not below <= mean <= above for mean in (5.0, 500.0, 5000.0)) == wanted
