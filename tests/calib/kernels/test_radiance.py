import numpy as np
import pytest
from numpy.random import default_rng

from calib.kernels.radiance import correct

f32 = np.float32


def numpy_twin(dn, terms, limits, base):
    """The same operations in the same order and precision, line by column."""
    dark, scale, c0, c1, c2, gain = terms
    signal = dn.astype(f32) - dark
    variance = c0 + signal * (c1 + c2 * signal)
    variance = variance + gain * np.maximum(signal, f32(0))
    std = np.sqrt(variance) * scale
    std = np.where(dn >= limits[2], std * f32(np.inf), std)
    flags = np.broadcast_to(base, dn.shape).copy()
    flags |= np.where(dn >= limits[2], 1, 0).astype(np.uint8)
    flags |= np.where((signal < 0) | (dn == 0), 2, 0).astype(np.uint8)
    flags |= np.where((dn < limits[0]) | (dn > limits[1]), 8, 0).astype(np.uint8)
    return signal * scale, std, flags


def some_terms(n_columns, seed):
    rng = default_rng(seed)
    scale = rng.uniform(1e-3, 1e-2, n_columns)
    scale[n_columns // 2] = np.nan
    columns = (
        rng.uniform(-9, 40, n_columns),
        scale,
        rng.uniform(0.1, 5, n_columns),
        -rng.uniform(0, 1e-3, n_columns),
        rng.uniform(1e-6, 1e-4, n_columns),
    )
    return (*(each.astype(f32) for each in columns), f32(0.07))


@pytest.mark.parametrize(("dtype", "full_scale"), [(np.uint8, 255), (np.uint16, 4095)])
@pytest.mark.parametrize("shape", [(1, 1), (7, 33), (40, 1021)])
def test_equals_the_numpy_twin_bit_for_bit(dtype, full_scale, shape):
    dn = default_rng(shape[1]).integers(0, full_scale + 1, shape).astype(dtype)
    dn.flat[0], dn.flat[-1] = 0, full_scale
    terms = some_terms(shape[1], seed=shape[0])
    base = default_rng(1).choice([0, 4, 48], shape[1]).astype(np.uint8)
    limits = (20, full_scale - 5, full_scale)
    out = np.empty(shape, f32), np.empty(shape, f32), np.empty(shape, np.uint8)
    correct(dn, terms, limits, base, out)
    for ours, twin in zip(out, numpy_twin(dn, terms, limits, base), strict=True):
        np.testing.assert_array_equal(ours, twin)


def test_leaving_out_the_uncertainty_changes_nothing_else():
    shape = (9, 257)
    dn = default_rng(3).integers(0, 4096, shape).astype(np.uint16)
    terms, base, limits = some_terms(257, seed=3), np.zeros(257, np.uint8), (20, 4000, 4095)
    full = np.empty(shape, f32), np.empty(shape, f32), np.empty(shape, np.uint8)
    bare = np.empty(shape, f32), None, np.empty(shape, np.uint8)
    correct(dn, terms, limits, base, full)
    correct(dn, terms, limits, base, bare)
    np.testing.assert_array_equal(full[0], bare[0])
    np.testing.assert_array_equal(full[2], bare[2])


def test_single_precision_costs_less_than_two_units_in_the_last_place_of_the_code():
    shape = (64, 500)
    dn = default_rng(4).integers(0, 65536, shape).astype(np.uint16)
    terms = some_terms(500, seed=4)
    out = np.empty(shape, f32), np.empty(shape, f32), np.empty(shape, np.uint8)
    correct(dn, terms, (0, 65535, 65535), np.zeros(500, np.uint8), out)
    dark, scale = (each.astype(np.float64) for each in terms[:2])
    exact = (dn - dark) * scale
    bound = 2 * np.finfo(f32).eps * np.maximum(dn, np.abs(dark)) * scale
    assert np.all((np.abs(out[0] - exact) <= bound) | np.isnan(exact))


@pytest.mark.parametrize("limits", [(-5, 70000, 4095), (-5, 4095, 4095)])
def test_limits_beyond_the_codes_flag_nothing_as_extrapolated(limits):
    dn = np.arange(4096, dtype=np.uint16)[:, None]
    terms = (*[np.ones(1, f32)] * 5, f32(1))
    out = np.empty((4096, 1), f32), None, np.empty((4096, 1), np.uint8)
    correct(dn, terms, limits, np.zeros(1, np.uint8), out)
    assert not (out[2] & 8).any()


@pytest.mark.parametrize(
    "dark", [-3.0, 0.0, 0.5, 1.0, 20.0, np.nextafter(f32(20), f32(21)), 65535.0, np.nan]
)
def test_codes_below_the_dark_level_and_code_zero_are_flagged_and_no_others(dark):
    dn = np.arange(65536, dtype=np.uint16)[:, None]
    terms = (np.full(1, dark, f32), *[np.ones(1, f32)] * 4, f32(1))
    base, limits = np.zeros(1, np.uint8), (0, 65535, 65535)
    out = np.empty((65536, 1), f32), None, np.empty((65536, 1), np.uint8)
    correct(dn, terms, limits, base, out)
    np.testing.assert_array_equal(out[2], numpy_twin(dn, terms, limits, base)[2])
