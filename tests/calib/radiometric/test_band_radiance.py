import numpy as np
import pytest
from numpy.random import default_rng

from calib.errors import InputError
from calib.radiometric.spectral.band_radiance import band_radiance
from calib.radiometric.spectral.band_radiance_spectra import LampSpectra
from calib.radiometric.spectral.spectral_response import SpectralResponse
from tests.calib.radiometric.example_scan import write_csv

GRID_NM = np.arange(760.0, 911.0, 3.0)
LAMP_NM = np.arange(700.0, 1001.0, 10.0)


def trapezium(std: float = 0.0) -> SpectralResponse:
    """1 from 790 to 850 nm, 0 up to 772 and from 892 nm on."""
    response = np.interp(GRID_NM, [772, 790, 850, 892], [0, 1, 1, 0])
    return SpectralResponse(GRID_NM, response, std * np.ones(len(GRID_NM)))


def lamps(levels=(0.1, 0.12), slope=0.0, own: float = 0.0, certificate: float = 0.0) -> LampSpectra:
    shape = 1 + slope * (LAMP_NM - 850)
    radiance = np.outer(levels, shape)
    names = tuple(f"lamp_{k + 1}" for k in range(len(levels)))
    return LampSpectra(LAMP_NM, radiance, own * radiance, certificate, names)


def test_a_flat_spectrum_gives_its_own_value_or_that_times_the_bandwidth():
    integrated = band_radiance(lamps(), trapezium())
    averaged = band_radiance(lamps(), trapezium(), quantity="band-averaged")
    area = np.trapezoid(trapezium().response, GRID_NM)
    np.testing.assert_allclose(integrated.radiance, np.array([0.1, 0.12]) * area)
    np.testing.assert_allclose(averaged.radiance, [0.1, 0.12])
    assert (integrated.unit, averaged.unit) == ("W m-2 sr-1", "W m-2 sr-1 nm-1")


def test_a_sloped_spectrum_is_weighted_by_the_response():
    symmetric = band_radiance(lamps((1.0,), slope=0.002), trapezium(), quantity="band-averaged")
    centroid = trapezium().centroid_nm.value
    expected = 1 + 0.002 * (centroid - 850)
    assert symmetric.radiance[0] == pytest.approx(expected, rel=2e-4)  # trapezoids of a parabola


def test_the_scale_of_the_response_leaves_the_average_alone():
    doubled = SpectralResponse.normalised(GRID_NM, 2 * trapezium().response, 0 * GRID_NM)
    for quantity in ("band-integrated", "band-averaged"):
        np.testing.assert_allclose(
            band_radiance(lamps(), doubled, quantity=quantity).radiance,
            band_radiance(lamps(), trapezium(), quantity=quantity).radiance,
        )


def test_no_point_of_either_grid_is_lost():
    line = LampSpectra(
        np.array([700.0, 840.4, 840.5, 840.6, 1000.0]),
        np.array([[0.0, 0.0, 10.0, 0.0, 0.0]]),
        np.zeros((1, 5)),
        0.0,
        ("line",),
    )
    assert band_radiance(line, trapezium()).radiance[0] == pytest.approx(10 * 0.1)


def test_levels_add_up_lamp_by_lamp():
    found = band_radiance(lamps((0.1, 0.12, 0.08)), trapezium())
    table = found.table()
    assert list(table) == [1.0, 2.0, 3.0]
    assert table[2.0] == pytest.approx(found.radiance[0] + found.radiance[1])
    assert found.of_lamps([2]).value == pytest.approx(found.radiance[2])
    assert found.of_lamps([]).value == 0


def test_the_certificate_is_common_to_all_lamps_and_each_lamps_own_is_not():
    common = band_radiance(lamps((0.1, 0.1), certificate=0.01), trapezium())
    own = band_radiance(lamps((0.1, 0.1), own=0.01), trapezium())
    assert common.of_lamps([0, 1]).std == pytest.approx(0.01 * common.radiance.sum())
    assert own.of_lamps([0, 1]).std == pytest.approx(0.01 * own.radiance.sum() / np.sqrt(2))
    levels = own.level_covariance()
    assert levels[0, 1] == pytest.approx(levels[0, 0])
    assert levels[1, 1] == pytest.approx(own.by_level()[2.0].std ** 2)


def _drawn_errors(correlation_length_nm, n, rng):
    if correlation_length_nm == 0:
        return rng.normal(size=(n, len(GRID_NM)))
    if np.isinf(correlation_length_nm):
        return rng.normal(size=(n, 1)) * np.ones(len(GRID_NM))
    step = np.exp(-3 / correlation_length_nm)
    errors = [rng.normal(size=n)]
    for _ in GRID_NM[1:]:
        errors.append(step * errors[-1] + np.sqrt(1 - step**2) * rng.normal(size=n))
    return np.array(errors).T


@pytest.mark.parametrize("quantity", ["band-integrated", "band-averaged"])
@pytest.mark.parametrize("correlation_length_nm", [0.0, 30.0, np.inf])
def test_the_responses_uncertainty_is_propagated_as_it_is_correlated(
    quantity, correlation_length_nm
):
    n, response, source = 500, trapezium(std=0.01), lamps((0.1, 0.05), slope=0.003)
    stated = band_radiance(
        source, response, quantity=quantity, correlation_length_nm=correlation_length_nm
    )
    rng = default_rng(round(min(correlation_length_nm, 99)))
    drawn = []
    for error in _drawn_errors(correlation_length_nm, n, rng):
        noisy = object.__new__(SpectralResponse)  # its peak is not at 1: the error is in the shape
        for name, value in (
            ("wavelength_nm", GRID_NM),
            ("response", response.response + 0.01 * error),
            ("std", response.std),
        ):
            object.__setattr__(noisy, name, value)
        found = band_radiance(source, noisy, quantity=quantity)
        drawn.append([found.radiance[0], found.radiance.sum()])
    for values, figure in zip(
        np.array(drawn).T, (stated.of_lamps([0]), stated.of_lamps([0, 1])), strict=True
    ):
        assert figure.std > 0
        assert abs(values.mean() - figure.value) < 4 * figure.std / np.sqrt(n)
        assert abs(values.std() / figure.std - 1) < 4 / np.sqrt(2 * n)


def test_a_flat_source_seen_on_average_does_not_depend_on_the_response():
    found = band_radiance(lamps((0.1,)), trapezium(std=0.05), quantity="band-averaged")
    assert found.of_lamps([0]).std < 1e-12


@pytest.mark.parametrize("grid_nm", [LAMP_NM[7:], LAMP_NM[:-10]])
def test_spectra_are_never_extrapolated(grid_nm):
    short = LampSpectra(grid_nm, np.ones((1, len(grid_nm))), np.zeros((1, len(grid_nm))), 0, ("a",))
    with pytest.raises(InputError) as error:
        band_radiance(short, trapezium())
    assert error.value.code == "spectrum-range"


@pytest.mark.parametrize("length_nm", [-1.0, np.nan])
def test_a_correlation_length_is_not_negative(length_nm):
    with pytest.raises(InputError) as error:
        band_radiance(lamps(), trapezium(), correlation_length_nm=length_nm)
    assert error.value.code == "correlation-length"


def test_a_file_of_spectra_is_read_by_lamp_and_in_order(tmp_path):
    path = write_csv(
        tmp_path / "lamps.csv",
        "wavelength_nm,left,left_std,right",
        ["800,0.2,0.01,0.4", "700,0.1,0.02,0.3"],
    )
    spectra = LampSpectra.load(path, certificate_relative_std=0.02)
    assert spectra.names == ("left", "right")
    np.testing.assert_array_equal(spectra.wavelength_nm, [700, 800])
    np.testing.assert_array_equal(spectra.radiance, [[0.1, 0.2], [0.3, 0.4]])
    np.testing.assert_array_equal(spectra.radiance_std, [[0.02, 0.01], [0, 0]])


@pytest.mark.parametrize(
    ("header", "row", "code"),
    [
        ("wavelength_nm", "800", "missing-column"),
        ("wavelength_nm,a,b_std", "800,1,1", "missing-column"),
        ("wavelength_nm,a", "800,-1", "out-of-range"),
        ("wavelength_nm,a", "800,nan", "bad-number"),
        ("wavelength_nm,a,a_std", "800,1,-1", "out-of-range"),
        ("lambda,a", "800,1", "missing-column"),
    ],
)
def test_spectra_that_are_none_are_refused(tmp_path, header, row, code):
    path = write_csv(tmp_path / "lamps.csv", header, [row])
    with pytest.raises(InputError) as error:
        LampSpectra.load(path, certificate_relative_std=0.01)
    assert error.value.code == code


@pytest.mark.parametrize("share", [-0.1, 1.0, np.nan])
def test_a_certificate_states_a_share(tmp_path, share):
    with pytest.raises(InputError) as error:
        LampSpectra.load(tmp_path / "any.csv", certificate_relative_std=share)
    assert error.value.code == "certificate-std"
