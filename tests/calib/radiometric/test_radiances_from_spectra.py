"""Radiances computed from spectra, and what they are uncertain by."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.random import default_rng

from calib.errors import DarkflatError, InputError
from calib.radiometric.spectral.band_radiance import band_radiance
from calib.radiometric.spectral.band_radiance_spectra import LampSpectra
from calib.radiometric.spectral.radiances_from_spectra import radiances_from_spectra
from calib.radiometric.spectral.spectral_response import SpectralResponse
from calib.recording.header import Block, CameraHeader, RecordingHeader, SourceHeader

NM = np.arange(760.0, 911.0, 10.0)
NAMES = ("a", "b", "c", "d")


def response(std: float = 0.0) -> SpectralResponse:
    """A triangle of 100 nm at its foot, 50 nm wide: bandwidth 50 nm."""
    shape = np.clip(1 - np.abs(NM - 830) / 50, 0, None)
    return SpectralResponse(NM, shape, std * np.ones(len(NM)))


def lamps(own_relative: float = 0.0, certificate: float = 0.0) -> LampSpectra:
    """Four lamps of flat spectra 1, 2, 3 and 4 W m-2 sr-1 nm-1."""
    radiance = np.outer([1.0, 2.0, 3.0, 4.0], np.ones(len(NM)))
    return LampSpectra(NM, radiance, own_relative * radiance, certificate, NAMES)


def header(*levels: float, **source: object) -> RecordingHeader:
    blocks = [
        Block(block=f"{k}", kind="flat", exposure_us=100, level=level)
        for k, level in enumerate(levels)
    ]
    dark = Block(block="dark", kind="dark", exposure_us=100)
    return RecordingHeader(
        camera=CameraHeader(columns=8, bit_depth=12),
        source=SourceHeader(**{"kind": "sphere", **source}),
        blocks=(*blocks, dark),
    )


def test_a_level_is_the_sum_of_its_first_lamps_in_the_band():
    found = radiances_from_spectra(header(1, 4, 2, 2), lamps(), response())
    assert found.unit == "W m-2 sr-1"
    assert found.by_level == pytest.approx({1.0: 50.0, 2.0: 150.0, 4.0: 500.0})


def test_without_any_uncertainty_none_is_stated():
    source = radiances_from_spectra(header(1, 2), lamps(), response()).source
    assert source.certificate_relative_std is None
    assert source.level_relative_std is None
    assert source.spectral_response_relative_std == 0.0


@pytest.mark.parametrize("levels", [(1, 2, 3, 4), (2, 4), (3,)])
def test_what_levels_share_and_what_they_do_not_make_the_mean_s_variance(levels):
    """With u the lamps' own errors: the relative error of level n is sum(u L) / sum(L)."""
    found = radiances_from_spectra(header(*levels), lamps(0.02), response()).source
    weights = [np.where(np.arange(4) < n, [1, 2, 3, 4], 0) / sum(range(1, n + 1)) for n in levels]
    expected = float(np.sum((0.02 * np.mean(weights, axis=0)) ** 2))
    own = found.level_relative_std**2 / len(levels)
    assert found.certificate_relative_std**2 + own == pytest.approx(expected)
    assert (own == 0) == (len(levels) == 1)


def test_the_certificate_is_shared_by_all_levels_and_adds_in_squares():
    alone = radiances_from_spectra(header(1, 4), lamps(0.0, 0.015), response()).source
    assert alone.certificate_relative_std == pytest.approx(0.015)
    both = radiances_from_spectra(header(1, 4), lamps(0.02, 0.015), response()).source
    own = radiances_from_spectra(header(1, 4), lamps(0.02), response()).source
    expected = np.hypot(0.015, own.certificate_relative_std)
    assert both.certificate_relative_std == pytest.approx(expected)
    assert both.level_relative_std == own.level_relative_std


@pytest.mark.parametrize("length_nm", [0.0, 30.0, np.inf])
def test_lamps_of_one_spectrum_share_all_that_the_response_errs(length_nm):
    found = radiances_from_spectra(
        header(1, 2, 3, 4), lamps(), response(0.01), correlation_length_nm=length_nm
    ).source
    one = band_radiance(lamps(), response(0.01), correlation_length_nm=length_nm).of_lamps([0])
    assert found.spectral_response_relative_std == pytest.approx(one.std / one.value)
    assert found.level_relative_std is None


def test_uncertainty_is_what_drawn_responses_and_lamps_scatter_by():
    rng, spectra, levels = default_rng(31), lamps(0.02), (1, 2, 3, 4)
    tilted = np.outer([1, 2, 3, 4], np.ones(len(NM))) * (
        1 + 0.004 * np.outer(np.arange(4), NM - 830)
    )
    spectra = replace(spectra, radiance=tilted, radiance_std=0.02 * tilted)
    found = radiances_from_spectra(header(*levels), spectra, response(0.01)).source
    truth = np.array(
        list(radiances_from_spectra(header(*levels), spectra, response()).by_level.values())
    )
    drawn = []
    for _ in range(400):
        own = spectra.radiance * (1 + 0.02 * rng.normal(size=(4, 1)))
        noisy = response().response + 0.01 * rng.normal(size=len(NM))
        weights = np.convolve(np.diff(NM, prepend=NM[0], append=NM[-1]), [0.5, 0.5], "valid")
        drawn.append(np.cumsum(own @ (weights * noisy)) / truth - 1)
    of_mean = found.certificate_relative_std**2 + found.level_relative_std**2 / 4
    of_mean += found.spectral_response_relative_std**2
    assert np.var(np.mean(drawn, axis=1)) == pytest.approx(of_mean, rel=4 * np.sqrt(2 / 400))


def test_what_else_is_stated_of_the_source_stays():
    stated = {"nonuniformity_relative": 0.01, "certificate": "C-1", "level_relative_std": 0.004}
    kept = radiances_from_spectra(header(1, 2, **stated), lamps(), response(0.01)).source
    assert (kept.nonuniformity_relative, kept.certificate) == (0.01, "C-1")
    assert kept.level_relative_std == 0.004
    own = radiances_from_spectra(header(1, 2, **stated), lamps(0.02), response()).source
    assert own.level_relative_std != 0.004


@pytest.mark.parametrize(
    ("recorded", "code", "names"),
    [
        (header(1, 5), "levels-not-lamps", "level 5"),
        (header(0), "levels-not-lamps", "level 0"),
        (header(1.5), "levels-not-lamps", "level 1.5"),
        (header(1, kind="led"), "levels-not-lamps", "LED"),
        (header(), "no-flats", "flat"),
    ],
)
def test_levels_that_are_no_lamps_are_refused(recorded, code, names):
    with pytest.raises(DarkflatError, match=names) as error:
        radiances_from_spectra(recorded, lamps(), response())
    assert error.value.code == code


def test_lamps_that_do_not_light_the_band_are_refused():
    dark = replace(lamps(), radiance=np.zeros((4, len(NM))))
    with pytest.raises(InputError) as error:
        radiances_from_spectra(header(1), dark, response())
    assert error.value.code == "dark-level"


def test_a_response_that_was_saved_is_the_same_when_read(tmp_path):
    path = tmp_path / "response.csv"
    response(0.01).save(path, comment="of a\nfilter")
    back = SpectralResponse.load(path)
    for name in ("wavelength_nm", "response", "std"):
        np.testing.assert_array_equal(getattr(back, name), getattr(response(0.01), name))
    assert path.read_text().startswith("# of a filter\nwavelength_nm,")
