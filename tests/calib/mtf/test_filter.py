"""The paper's filter: Eq. 6, its noise (Eq. 10 as derived), Fig. 4's cases, and what it costs."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.random import default_rng
from numpy.typing import NDArray

from calib.errors import InputError, NotDeterminedError
from calib.mtf.assembly.oversampled import Oversampled, oversampled
from calib.mtf.filter.filter_estimate import filter_estimate
from calib.mtf.filter.overlap import Overlap, harmonics_seen, overlap, weights
from calib.mtf.filter.regressive_filter import RegressiveFilter
from calib.mtf.filter.thumbnails import Thumbnails, at_frequencies
from calib.mtf.filter.window import Window
from calib.mtf.geometry import Alignment, Scan
from calib.mtf.grating.grating import Grating
from calib.mtf.simulation.response import centred
from tests.calib.mtf.simulated import CORNER, ORDERS_24, ORDERS_48, PAPER, exact_fit, record

WINDOW = Window(3 * np.sqrt(37))


@pytest.fixture(scope="module")
def grid() -> Oversampled:
    fit = exact_fit(CORNER, ORDERS_24, (56, 56))
    return oversampled(fit, np.zeros(2), select_harmonics=True)


def disc(grating: Grating, grid: Oversampled, n: int = 15) -> NDArray[np.floating]:
    """Frequencies all over the disc, cycles per step, (n, 2)."""
    axis = np.linspace(-1, 1, n) * grating.max_frequency_per_um * grid.step_um
    points = np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2)
    return points[np.hypot(*points.T) <= axis[-1]]


def test_images_are_put_where_they_were_taken() -> None:
    case = record(default_rng(), (20, 24))
    fit = exact_fit(CORNER, ORDERS_24, (20, 24))
    shown = oversampled(
        replace(fit, residual=case.scan.images), np.zeros(2), select_harmonics=False
    )
    bare = oversampled(fit, np.zeros(2), select_harmonics=True)
    put = (shown.image - bare.image) * fit.mean
    row, column = np.arange(20)[:, None], np.arange(24)[None, :]
    for k in (0, 17, 36):
        np.testing.assert_allclose(
            put[column + 6 * row, 6 * column - row + k + 19], case.scan.images[k]
        )
    assert shown.covered.sum() == 37 * 20 * 24


def test_selected_harmonics_are_what_noise_free_images_hold() -> None:
    alignment = Alignment(-_centroid_in_the_grating_s_frame())
    light = record(default_rng(), (20, 24), alignment=alignment).bench.light()
    grid = oversampled(exact_fit(CORNER, ORDERS_24, (20, 24)), np.zeros(2), select_harmonics=True)
    row, column = np.arange(20)[:, None], np.arange(24)[None, :]
    for k in (0, 17, 36):
        np.testing.assert_allclose(
            grid.image[column + 6 * row, 6 * column - row + k + 19], light[k] - 1, atol=1e-9
        )


@pytest.mark.parametrize("taper", [0.1, 0.5, 1.0])
def test_a_window_is_as_wide_as_it_says(taper: float) -> None:
    window = Window(18.0, taper)
    assert len(window.values) % 2 == 1
    half = len(window.values) // 2
    assert window.values[half] == 1.0
    assert window.values[half + 9] == pytest.approx(0.5)
    assert window.overlap(0) == pytest.approx((window.values**2).sum())
    assert window.overlap(2 * half + 1) == 0.0


def test_correlations_hold_the_sums_of_spectra_at_any_frequency(grid: Oversampled) -> None:
    thumbnails = Thumbnails(WINDOW, grid.covered, most=5)
    filtering = RegressiveFilter.of(thumbnails, grid.pattern)
    size = len(WINDOW.values)
    frequency = default_rng().uniform(-0.4, 0.4, (6, 2))
    at = np.arange(size)
    turn_x, turn_y = (np.exp(-2j * np.pi * np.multiply.outer(frequency[:, k], at)) for k in (0, 1))
    total, seen = np.zeros(6), np.zeros(6, np.complex128)
    shape = np.multiply.outer(WINDOW.values, WINDOW.values)
    for j, i in np.argwhere(thumbnails.used) * thumbnails.step:
        known, image = (
            np.einsum("fy,yx,fx->f", turn_y, each[j : j + size, i : i + size] * shape, turn_x)
            for each in (grid.pattern, grid.image)
        )
        total += np.abs(known) ** 2
        seen += image * known.conj()
    np.testing.assert_allclose(at_frequencies(filtering.denominator, frequency), total, rtol=1e-8)
    made = filtering.transfer(filtering.numerator(grid.image), frequency)
    np.testing.assert_allclose(made, seen / total, rtol=1e-8)


def noise_ratio(grid: Oversampled, most: int, runs: int) -> tuple[float, float]:
    """Return the disc's mean std over noisy runs, and as predicted, for σ_I = 1."""
    filtering = RegressiveFilter.of(Thumbnails(WINDOW, grid.covered, most), grid.pattern)
    frequency, rng = disc(ORDERS_24, grid), default_rng()
    drawn = [
        filtering.transfer(
            filtering.numerator(rng.normal(size=grid.image.shape) * grid.covered), frequency
        )
        for _ in range(runs)
    ]
    return float(np.std(drawn, axis=0).mean()), float(filtering.noise_gain(frequency).mean())


def test_noise_is_as_predicted_within_5_percent_over_100_runs(grid: Oversampled) -> None:
    measured, predicted = noise_ratio(grid, 0, 100)
    assert abs(measured / predicted - 1) < 0.05


def test_noise_is_exactly_that_of_the_sum_over_overlapping_windows(grid: Oversampled) -> None:
    thumbnails = Thumbnails(WINDOW, grid.covered, most=12)
    filtering = RegressiveFilter.of(thumbnails, grid.pattern)
    frequency = disc(ORDERS_24, grid, 5)
    size, shape = len(WINDOW.values), np.multiply.outer(WINDOW.values, WINDOW.values)
    y, x = np.mgrid[:size, :size]
    expected = []
    for fx, fy in frequency:
        turn = shape * np.exp(-2j * np.pi * (fx * x + fy * y))
        weight, total = np.zeros(grid.image.shape, np.complex128), 0.0
        for j, i in np.argwhere(thumbnails.used) * thumbnails.step:
            known = (grid.pattern[j : j + size, i : i + size] * turn).sum()
            weight[j : j + size, i : i + size] += known.conj() * turn
            total += abs(known) ** 2
        expected.append(np.sqrt((np.abs(weight) ** 2).sum()) / total)
    np.testing.assert_allclose(filtering.noise_gain(frequency), expected, rtol=1e-8)


def test_noise_is_linear_in_the_image_s(grid: Oversampled) -> None:
    filtering = RegressiveFilter.of(Thumbnails(WINDOW, grid.covered, 20), grid.pattern)
    frequency, noise = disc(ORDERS_24, grid), default_rng().normal(size=grid.image.shape)
    clean = filtering.transfer(filtering.numerator(grid.image), frequency)
    away = [
        filtering.transfer(filtering.numerator(grid.image + s * noise), frequency) - clean
        for s in (0.01, 1.0)
    ]
    np.testing.assert_allclose(100 * away[0], away[1], atol=1e-8)


def test_noise_falls_as_one_over_the_root_of_the_thumbnails(grid: Oversampled) -> None:
    every = Thumbnails(WINDOW, grid.covered).count
    counts = np.array([every // 16, every // 4, every])
    gains = [
        RegressiveFilter.of(Thumbnails(WINDOW, grid.covered, n), grid.pattern)
        .noise_gain(disc(ORDERS_24, grid))
        .mean()
        for n in counts.tolist()
    ]
    slope = np.polyfit(np.log(counts), np.log(gains), 1)[0]
    # Few thumbnails see the pattern by chance: 1/16 of them hold about one cell of it.
    assert slope == pytest.approx(-0.5, abs=0.05)


def test_eq_10_as_printed_is_not_what_happens(grid: Oversampled) -> None:
    filtering = RegressiveFilter.of(Thumbnails(WINDOW, grid.covered), grid.pattern)
    frequency, n = disc(ORDERS_24, grid), filtering.thumbnails.count
    root_mean_square = 1 / np.sqrt(n * at_frequencies(filtering.denominator, frequency).real)
    printed_at_best = np.sqrt(n) * root_mean_square  # the mean of M is smaller still
    share = printed_at_best.mean() / filtering.noise_gain(frequency).mean()
    energy = WINDOW.overlap(0)
    assert share == pytest.approx(1 / energy, rel=0.15)  # √E_w = overlap(0) in two dimensions
    assert share < 0.1


def test_eq_6_is_the_harmonics_mean_weighted_with_the_window_s_power() -> None:
    fit = exact_fit(CORNER, ORDERS_24, (120, 120))
    grid = oversampled(fit, np.zeros(2), select_harmonics=True)
    filtering = RegressiveFilter.of(Thumbnails(WINDOW, grid.covered), grid.pattern)
    frequency = disc(ORDERS_24, grid)
    found = filtering.transfer(filtering.numerator(grid.image), frequency)
    both = np.vstack([fit.state.harmonics.frequency_per_um, -fit.state.harmonics.frequency_per_um])
    share = weights(WINDOW, frequency, both * grid.step_um)
    share = share * np.abs(np.tile(fit.state.harmonics.amplitude, 2)) ** 2
    transfer = np.concatenate([fit.transfer, fit.transfer.conj()])
    expected = (share @ transfer) / share.sum(1)
    # What is left are products of different harmonics, which fall as one over the root of n.
    assert np.sqrt((np.abs(found - expected) ** 2).mean()) < 0.3 / np.sqrt(
        filtering.thumbnails.count
    )


def test_one_percent_cannot_be_had_from_eq_6_as_printed() -> None:
    """Section 4 of the paper states errors below 1 %; the window's smoothing alone is more."""
    fit = exact_fit(CORNER, ORDERS_48, (64, 64))
    found = filter_estimate(fit, np.zeros(2))
    axis = np.linspace(-1, 1, 31) * ORDERS_48.max_frequency_per_um
    seen = found.at(axis, axis)
    fy, fx = np.meshgrid(axis, axis, indexing="ij")
    error = np.abs(seen.transfer - centred(CORNER, fx, fy))[seen.valid]
    assert 0.05 < error.max() < 0.15
    assert 0.01 < np.sqrt((error**2).mean()) < 0.02


def _centroid_in_the_grating_s_frame() -> NDArray[np.floating]:
    x, y = CORNER.centroid_um
    cos, sin = np.cos(PAPER.tilt_rad), np.sin(PAPER.tilt_rad)
    return np.array([cos * x - sin * y, sin * x + cos * y])


def test_its_error_bars_are_those_of_noisy_harmonics() -> None:
    rng, std = default_rng(), 1e-3
    fit = exact_fit(CORNER, ORDERS_24, (56, 56), std)
    axis = np.linspace(-1, 1, 9) * 0.09
    clean = filter_estimate(fit, np.zeros(2)).at(axis, axis)
    squares = []
    for _ in range(20):
        noise = std * rng.normal(size=(2, len(fit.transfer))) * [[1], [1j]]
        amplitude = fit.state.amplitude.copy()
        amplitude[1:] += noise.sum(0) * fit.state.harmonics.amplitude
        noisy = replace(fit, state=replace(fit.state, amplitude=amplitude))
        error = filter_estimate(noisy, np.zeros(2)).at(axis, axis).transfer - clean.transfer
        squares.append(((error.real / clean.real_std)[clean.valid] ** 2).mean())
    # The products of different harmonics, which the weights leave out, add a few per cent.
    assert np.mean(squares) == pytest.approx(1, abs=4 * np.std(squares) / np.sqrt(20) + 0.1)


@pytest.mark.parametrize(
    ("spacing", "case"), [(0.25, Overlap.NONE), (0.075, Overlap.WEAK), (0.02, Overlap.STRONG)]
)
def test_the_three_cases_of_figure_4(spacing: float, case: Overlap) -> None:
    middle = np.array([[spacing / 2, 0.0]])
    line = np.stack([spacing * np.arange(-20, 21), np.zeros(41)], axis=1)
    assert overlap(harmonics_seen(WINDOW, middle, line))[0] == case


def test_harmonics_too_far_apart_are_refused() -> None:
    fit = exact_fit(CORNER, Grating(5, 40.0), (56, 56))
    with pytest.raises(NotDeterminedError, match="overlap") as refused:
        filter_estimate(fit, np.zeros(2))
    assert refused.value.code == "no-overlap"


def test_a_grid_too_coarse_for_the_pattern_is_refused() -> None:
    fit = exact_fit(CORNER, ORDERS_24, (30, 30))
    coarse = replace(fit.state.sampling, scan=Scan(25.0, 1, 2), frames=tuple(range(5)))
    with pytest.raises(NotDeterminedError, match="102/mm") as refused:
        oversampled(
            replace(fit, state=replace(fit.state, sampling=coarse)), np.zeros(2),
            select_harmonics=True,
        )  # fmt: skip
    assert refused.value.code == "grid-too-coarse"


def test_a_detector_too_small_for_one_window_is_refused() -> None:
    fit = exact_fit(CORNER, ORDERS_24, (3, 3))
    with pytest.raises(NotDeterminedError, match="larger part") as refused:
        filter_estimate(fit, np.zeros(2))
    assert refused.value.code == "detector-too-small"


@pytest.mark.parametrize(("width", "taper"), [(18.0, 0.0), (18.0, 1.5), (1.0, 0.5)])
def test_a_window_that_cannot_be_is_refused(width: float, taper: float) -> None:
    with pytest.raises(InputError):
        Window(width, taper)
