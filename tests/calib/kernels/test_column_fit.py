import numpy as np
import pytest
from numpy.random import default_rng

from calib.errors import InputError
from calib.kernels.column_fit import LineFit, fit_lines

EXPOSURES_US = np.array([100.0, 200.0, 300.0, 400.0, 500.0])


def einsum_twin(means, weights, exposures) -> LineFit:
    """The normal equations, column by column, in plain NumPy."""
    w = np.ones(means.shape) if weights is None else weights
    w = np.broadcast_to(w[:, None] if w.ndim == 1 else w, means.shape)
    y = np.where(w > 0, means.astype(np.float64), 0.0)
    s, sx, sxx = (np.einsum("kn,k->n", w, exposures**power) for power in (0, 1, 2))
    sy, sxy = (np.einsum("kn,kn,k->n", w, y, exposures**power) for power in (0, 1))
    determinant = s * sxx - sx**2
    return LineFit(
        (sxx * sy - sx * sxy) / determinant,
        (s * sxy - sx * sy) / determinant,
        sxx / determinant,
        s / determinant,
        -sx / determinant,
    )


def assert_same(fit: LineFit, twin: LineFit, *, rtol: float) -> None:
    scale = np.nanmax(np.abs(twin.offset)) + np.nanmax(np.abs(twin.slope)) * EXPOSURES_US.max()
    np.testing.assert_allclose(fit.offset, twin.offset, rtol=0, atol=rtol * scale)
    np.testing.assert_allclose(fit.slope, twin.slope, rtol=0, atol=rtol * scale / 100)
    for name in ("offset_variance", "slope_variance", "covariance"):
        np.testing.assert_allclose(getattr(fit, name), getattr(twin, name), rtol=max(rtol, 1e-9))


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.float32, np.float64])
@pytest.mark.parametrize("weighting", ["none", "shared", "columns"])
def test_agrees_with_the_normal_equations(dtype, weighting):
    rng = default_rng(5)
    means = rng.uniform(0, 250, (5, 1003)).astype(dtype)
    weights = {
        "none": None,
        "shared": rng.uniform(0.5, 2, 5),
        "columns": rng.uniform(0.5, 2, (5, 1003)),
    }[weighting]
    fit = fit_lines(means, weights, EXPOSURES_US)
    rtol = 1e-12 if dtype == np.float64 else 2 * np.finfo(np.float32).eps
    assert_same(fit, einsum_twin(means, weights, EXPOSURES_US), rtol=rtol)
    assert fit.offset.dtype == (np.float64 if dtype == np.float64 else np.float32)


def test_a_straight_line_comes_back_however_far_from_zero_the_exposures_are():
    exposures = 1e6 + np.array([0.0, 1.0, 2.0, 3.0])
    slope = np.array([0.5, -2.0, 3.25])
    means = 7.0 + (exposures[:, None] - 1e6) * slope
    for weights in (None, np.ones((4, 3))):
        fit = fit_lines(means, weights, exposures)
        np.testing.assert_allclose(fit.slope, slope, rtol=1e-9)
        np.testing.assert_allclose(fit.offset, 7.0 - 1e6 * slope, rtol=1e-9)


@pytest.mark.parametrize("shared", [True, False])
def test_weight_zero_leaves_a_sample_out_even_when_it_is_nan(shared):
    means = default_rng(6).normal(100, 1, (5, 40))
    weights = np.array([1.0, 2.0, 0.0, 1.0, 3.0])
    spoiled = means.copy()
    spoiled[2] = np.nan
    kept = [0, 1, 3, 4]
    full = weights if shared else np.repeat(weights[:, None], 40, axis=1)
    fit = fit_lines(spoiled, full, EXPOSURES_US)
    assert_same(fit, einsum_twin(means[kept], weights[kept], EXPOSURES_US[kept]), rtol=1e-12)


def test_a_column_with_one_distinct_exposure_is_not_determined():
    weights = np.ones((5, 3))
    weights[1:, 1] = 0
    weights[:, 2] = 0
    fit = fit_lines(np.ones((5, 3)), weights, EXPOSURES_US)
    for name in ("offset", "slope", "offset_variance", "slope_variance", "covariance"):
        assert np.isnan(getattr(fit, name)).tolist() == [False, True, True]


def test_stated_variances_are_those_of_the_estimates():
    n = 40_000
    std = np.array([1.0, 1.5, 2.0, 2.5, 3.0])
    means = 5 + 0.3 * EXPOSURES_US[:, None] + default_rng(7).normal(size=(5, n)) * std[:, None]
    fit = fit_lines(means, np.repeat(1 / std[:, None] ** 2, n, axis=1), EXPOSURES_US)
    offset_z = (fit.offset - 5) / np.sqrt(fit.offset_variance)
    slope_z = (fit.slope - 0.3) / np.sqrt(fit.slope_variance)
    correlation = fit.covariance[0] / np.sqrt(fit.offset_variance[0] * fit.slope_variance[0])
    for z in (offset_z, slope_z):
        assert abs(z.mean()) < 4 / np.sqrt(n)
        assert abs(z.std() - 1) < 4 / np.sqrt(2 * n)
    standard_error = (1 - correlation**2) / np.sqrt(n)
    assert abs(np.corrcoef(offset_z, slope_z)[0, 1] - correlation) < 4 * standard_error


@pytest.mark.parametrize(
    ("means", "weights", "exposures", "code"),
    [
        (np.ones(5), None, EXPOSURES_US, "fit-shape"),
        (np.ones((4, 3)), None, EXPOSURES_US, "fit-shape"),
        (np.ones((5, 3)), np.ones((3, 5)), EXPOSURES_US, "fit-shape"),
        (np.ones((5, 3)), -np.ones(5), EXPOSURES_US, "fit-weights"),
        (np.ones((5, 3)), np.full((5, 3), np.nan), EXPOSURES_US, "fit-weights"),
        (np.ones((5, 3)), None, np.full(5, 200.0), "too-few-exposures"),
        (np.ones((5, 3)), np.array([1.0, 0, 0, 0, 0]), EXPOSURES_US, "too-few-exposures"),
    ],
)
def test_what_does_not_fit_together_is_refused(means, weights, exposures, code):
    with pytest.raises(InputError) as error:
        fit_lines(means, weights, exposures)
    assert error.value.code == code


def test_inputs_are_left_as_they_were():
    means, weights = np.ones((5, 3)), np.ones((5, 3))
    means.flags.writeable = weights.flags.writeable = False
    fit_lines(means, weights, EXPOSURES_US)
    fit_lines(means, None, EXPOSURES_US)


def test_estimates_go_where_they_are_wanted():
    means = default_rng(8).uniform(0, 100, (5, 70)).astype(np.float32)
    out = np.empty((2, 70), np.float32)
    fit = fit_lines(means, None, EXPOSURES_US, out=out)
    fresh = fit_lines(means, None, EXPOSURES_US)
    assert np.shares_memory(fit.offset, out)
    np.testing.assert_array_equal(out, [fresh.offset, fresh.slope])


@pytest.mark.parametrize("out", [np.empty((2, 69), np.float32), np.empty((2, 70))])
def test_estimates_are_not_put_where_they_do_not_fit(out):
    with pytest.raises(InputError) as error:
        fit_lines(np.ones((5, 70), np.float32), None, EXPOSURES_US, out=out)
    assert error.value.code == "fit-shape"
