"""Two real sensors: a 12-bit CCD of which sums survive, and a CCD of four taps with its frames."""

from pathlib import Path

import numpy as np
import pytest

from calib.recording.folder_recording import FolderRecording
from calib.transfer.photon_transfer.curve_fit import Model
from calib.transfer.photon_transfer.measure import photon_transfer
from calib.transfer.photon_transfer.result import PhotonTransfer
from examples.photon_transfer import (
    CCD12,
    RANGES_DN,
    folder_of_frames,
    folder_of_sums,
    sample_files,
)


@pytest.fixture(scope="module")
def ccd12(tmp_path_factory: pytest.TempPathFactory) -> FolderRecording:
    table = CCD12 / "ptc_table.csv"
    if not table.exists():
        pytest.skip(f"{table} is not there")
    return FolderRecording(folder_of_sums(table, tmp_path_factory.mktemp("ccd12") / "sums"))


@pytest.fixture(scope="module")
def of_ccd12(ccd12: FolderRecording) -> PhotonTransfer:
    return photon_transfer(ccd12)


@pytest.mark.shared
def test_a_bent_response_gives_the_ccd_s_gain_and_noise(of_ccd12: PhotonTransfer) -> None:
    assert of_ccd12.model == "nonlinear"
    assert abs(of_ccd12.system_gain.value - 0.291) < 0.002
    assert of_ccd12.system_gain.std < 0.001
    # 3.07 DN by the darks' variance, which has rounding in it.
    with_rounding = np.sqrt(of_ccd12.read_noise_dn.value**2 + 1 / 12)
    assert abs(with_rounding - 3.07) < 0.01


@pytest.mark.shared
def test_a_straight_line_s_gain_falls_with_its_range(ccd12: FolderRecording) -> None:
    gains = []
    for most in (RANGES_DN[0], RANGES_DN[3], RANGES_DN[-1]):
        fit = photon_transfer(ccd12, most_dn=most).taps[0].choice.fits[Model.STRAIGHT]
        gains.append(fit.shape.system_gain)
    assert gains[0] > gains[1] > gains[2]
    assert 0.281 < gains[-1] < 0.283
    assert 0.2875 < gains[0] < 0.2885


@pytest.mark.shared
def test_the_ccd_s_curve_is_bent_by_its_response_and_not_by_charge(
    of_ccd12: PhotonTransfer,
) -> None:
    choice = of_ccd12.taps[0].choice
    assert choice.beta_sigma > 8
    assert choice.a00_sigma > -1
    assert choice.used is Model.NONLINEAR
    fits = choice.fits
    assert fits[Model.BRIGHTER_FATTER].aicc - fits[Model.NONLINEAR].aicc > 100
    assert fits[Model.STRAIGHT].aicc - fits[Model.NONLINEAR].aicc > 150
    # The variances scatter more than 614,400 samples allow, and that is in the errors.
    assert fits[Model.NONLINEAR].variance_excess.flats.relative > 2 * np.sqrt(4 / 614400)


@pytest.mark.shared
def test_the_ccd_turns_off_where_its_codes_end(of_ccd12: PhotonTransfer) -> None:
    tap = of_ccd12.taps[0]
    assert tap.used.turn_off_dn == pytest.approx(3905.7, abs=0.1)
    assert tap.used.highest_dn == tap.used.turn_off_dn
    assert any("statistics.csv" in text for text in of_ccd12.warnings)


@pytest.fixture(scope="module")
def of_taps(tmp_path_factory: pytest.TempPathFactory) -> PhotonTransfer:
    files: Path | None = sample_files()
    if files is None:
        pytest.skip("the package msfc-ccd is not installed: make setup")
    folder = folder_of_frames(files, tmp_path_factory.mktemp("msfc") / "frames")
    return photon_transfer(FolderRecording(folder))


def test_every_tap_has_its_gain_and_noise(of_taps: PhotonTransfer) -> None:
    assert len(of_taps.taps) == 4
    assert abs(of_taps.system_gain.value - 0.398) < 0.002
    assert of_taps.system_gain.std < 0.001
    for tap in of_taps.taps:
        assert abs(tap.system_gain.value - 0.398) < 0.005
        assert abs(tap.read_noise_dn.value - 4.0) < 0.3


def test_a_tap_s_variance_is_that_of_the_plain_difference(of_taps: PhotonTransfer) -> None:
    files = sample_files()
    assert files is not None
    from astropy.io import fits

    one, other = (
        fits.getdata(files / f"ESIS1_{n:05d}.fit.gz")[20:520, 60:1066].astype(float)
        for n in (4803, 4804)
    )
    difference = one - other
    kept = np.abs(difference - np.median(difference)) < 5 * difference.std()
    plain = difference[kept].var(ddof=1) / 2
    points = of_taps.taps[0].points
    flats = points.where(~points.is_dark)
    ours = np.average(flats.variance_dn2, weights=flats.pixels)
    # The two cut at other limits, and ours leaves defects out: a tenth of the statistical error.
    assert abs(ours / plain - 1) < np.sqrt(2 / kept.sum())


def test_neighbours_correlate_a_little_and_surely(of_taps: PhotonTransfer) -> None:
    lags = of_taps.taps[0].points.lags
    for lag in ((0, 1), (1, 0)):
        found = [tap.neighbours[lags.index(lag)] for tap in of_taps.taps]
        mean = np.mean([n.correlation for n in found])
        error = np.sqrt(np.sum([n.correlation_std**2 for n in found])) / 4
        assert mean > 4 * error
        assert mean < 0.01
        # Taps agree: chi-squared of three degrees of freedom is below 16 in 999 of 1000 cases.
        spread = sum(((n.correlation - mean) / n.correlation_std) ** 2 for n in found)
        assert spread < 16.3
