import numpy as np
import pytest
from numpy.random import default_rng

from calib.errors import DarkflatError
from calib.radiometric.spectral.spectral_response import SpectralResponse
from tests.calib.radiometric.example_scan import write_csv

GRID_NM = np.arange(700.0, 1001.0, 3.0)


def triangle(std: float = 0.0) -> SpectralResponse:
    """Peak at 850 nm, zero 60 nm to both sides."""
    response = np.clip(1 - np.abs(GRID_NM - 850) / 60, 0, None)
    return SpectralResponse.normalised(GRID_NM, response, np.full(len(GRID_NM), std))


def test_figures_of_a_triangle():
    shape = triangle()
    assert shape.half_maximum_nm == pytest.approx((820, 880))
    assert shape.centre_wavelength_nm.value == pytest.approx(850)
    assert shape.fwhm_nm.value == pytest.approx(60)
    assert shape.centroid_nm.value == pytest.approx(850)
    assert shape.bandwidth_nm.value == pytest.approx(60)
    assert shape.band_nm == pytest.approx((790.6, 909.4), abs=0.5)
    assert shape.out_of_band_fraction.value == pytest.approx(1e-4, abs=1e-4)


def test_a_leak_is_out_of_band():
    response = triangle().response.copy()
    response[5:9] = 0.05
    leaking = SpectralResponse.normalised(GRID_NM, response, np.zeros(len(GRID_NM)))
    leak = 0.05 * 4 * 3
    assert leaking.out_of_band_fraction.value == pytest.approx(leak / (60 + leak), abs=2e-4)
    assert leaking.band_nm == triangle().band_nm


def test_a_band_that_never_ends_has_no_out_of_band_fraction():
    pedestal = SpectralResponse.normalised(
        GRID_NM, 0.02 + triangle().response, np.zeros(len(GRID_NM))
    )
    assert pedestal.band_nm is None
    assert pedestal.out_of_band_fraction is None


def test_figures_scatter_as_they_state():
    names = ("centre_wavelength_nm", "fwhm_nm", "centroid_nm", "bandwidth_nm")
    truth = triangle(std=0.004)
    found = {name: [] for name in names}
    n = 400
    for rng in default_rng(3).spawn(n):
        noisy = truth.response + truth.std * rng.normal(size=len(GRID_NM))
        drawn = SpectralResponse(GRID_NM, noisy / noisy.max(), truth.std)
        scaled = SpectralResponse.normalised(GRID_NM, noisy, truth.std)
        for name in names:
            found[name].append(getattr(drawn, name).value * (
                noisy.max() if name == "bandwidth_nm" else 1
            ))  # fmt: skip
        assert scaled.fwhm_nm.value == pytest.approx(drawn.fwhm_nm.value)
    for name in names:
        figure = getattr(truth, name)
        z = (np.array(found[name]) - figure.value) / figure.std
        assert abs(z.mean()) < 4 / np.sqrt(n) + 0.1  # the peak of noisy points lies above 1
        assert abs(z.std() - 1) < 4 / np.sqrt(2 * n)


@pytest.mark.parametrize(
    ("response", "code"),
    [
        (np.zeros(101), "no-response"),
        (np.linspace(0, 1, 101), "band-not-covered"),
        (np.linspace(1, 0, 101), "band-not-covered"),
    ],
)
def test_what_has_no_band_says_so(response, code):
    with pytest.raises(DarkflatError) as error:
        _ = SpectralResponse.normalised(GRID_NM, response, np.zeros(101)).fwhm_nm
    assert error.value.code == code


@pytest.mark.parametrize(
    "arrays",
    [
        (np.array([1.0]), np.array([1.0]), np.array([0.0])),
        (GRID_NM, np.ones(5), np.zeros(101)),
        (GRID_NM, 2 * np.ones(101), np.zeros(101)),
    ],
)
def test_arrays_that_are_no_response_are_refused(arrays):
    with pytest.raises(DarkflatError) as error:
        SpectralResponse(*arrays)
    assert error.value.code == "bad-response"


def test_a_file_gives_the_response_in_order_and_normalised(tmp_path):
    path = write_csv(
        tmp_path / "r.csv",
        "wavelength_nm,response,response_std",
        ["# made by hand", "800,2,0.02", "790,0,0.01", "810,1,0.03"],
    )
    response = SpectralResponse.load(path)
    np.testing.assert_array_equal(response.wavelength_nm, [790, 800, 810])
    np.testing.assert_array_equal(response.response, [0, 1, 0.5])
    np.testing.assert_array_equal(response.std, [0.005, 0.01, 0.015])


@pytest.mark.parametrize(
    ("text", "code"),
    [
        (None, "not-found"),
        ("", "empty-table"),
        ("wavelength_nm,response\n", "empty-table"),
        ("wavelength_nm\n800\n", "missing-column"),
        ("wavelength_nm,response,respnse_std\n800,1,0\n", "unknown-column"),
        ("wavelength_nm,response,response\n800,1,0\n", "unknown-column"),
        ("wavelength_nm,response\n800,1,7\n", "unreadable"),
        ("wavelength_nm,response\n800,nan\n", "bad-number"),
        ("wavelength_nm,response\n800,\n", "bad-number"),
        ("wavelength_nm,response\n800,1\n800,0.5\n", "wavelength-twice"),
        ("wavelength_nm,response\n-800,1\n800,0.5\n", "out-of-range"),
        ("wavelength_nm,response,response_std\n790,1,-1\n800,0.5,0\n", "out-of-range"),
        (b"\xff\xfe\x00", "unreadable"),
    ],
)
def test_files_that_are_none_are_refused(tmp_path, text, code):
    path = tmp_path / "r.csv"
    if text is not None:
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(DarkflatError) as error:
        SpectralResponse.load(path)
    assert error.value.code == code
    assert "r.csv" in str(error.value)
