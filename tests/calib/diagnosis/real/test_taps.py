"""A real CCD of four taps, two flats and two darks: what the taps share in the dark has no name."""

from pathlib import Path

import numpy as np
import pytest

from calib.diagnosis.diagnose import Examination, diagnose
from calib.recording.folder_recording import FolderRecording
from examples.photon_transfer import sample_files
from examples.real.folders import BOX, folder_of_taps
from examples.real.numbers import dark_growth, dark_pair, deferred, spectrum


@pytest.fixture(scope="module")
def files() -> Path:
    found = sample_files()
    if found is None:
        pytest.skip("the package msfc-ccd is not installed: make setup")
    return found


@pytest.fixture(scope="module")
def found(files: Path, tmp_path_factory: pytest.TempPathFactory) -> Examination:
    return diagnose(FolderRecording(folder_of_taps(files, tmp_path_factory.mktemp("taps") / "a")))


def test_every_tap_s_gain_is_that_of_photon_transfer(found: Examination) -> None:
    # docs/photon-transfer/curve.md, of all pixels; here of 48 x 96 in one pair.
    gains = np.array([0.3963, 0.4000, 0.3956, 0.3984])
    std = np.sqrt(2.0 / (BOX[0] * BOX[1])) * gains
    assert np.all(np.abs(found.evidence.baseline.gain_dn_per_e - gains) < 4.0 * std)


def test_what_the_taps_share_in_the_dark_is_called_unexplained(found: Examination) -> None:
    rest = found.diagnosis.unexplained
    assert rest is not None
    assert rest.where.statistic == "column_covariance"
    assert rest.where.depends_on == ("tap",)
    assert "dark" in rest.where.blocks


def test_what_two_frames_cannot_show_is_not_named(found: Examination) -> None:
    named = {f.effect.name for f in found.diagnosis.findings}
    # What the taps share is the same in the dark and in the light: no crosstalk of signal.
    assert "tap_crosstalk" not in named
    for name in ("stuck_bit", "adc_dnl", "persistence", "heavy_tailed_noise"):
        assert name not in named
        assert name in found.diagnosis.not_testable
    assert "4 frames or more" in found.diagnosis.not_testable["stuck_bit"]
    assert found.diagnosis.remarks[0].startswith("All flats have one signal")


def test_dark_noise_is_shared_by_the_taps_and_holds_tones(files: Path) -> None:
    noise = dark_pair(files)
    shared = np.corrcoef([n.ravel() for n in noise])[np.triu_indices(4, 1)]
    assert np.all((shared > 0.55) & (shared < 0.65))
    power = spectrum(noise[0])
    # Of half a million bins of white noise the highest is 13 to 20 times the mean.
    assert power.max() > 1000 * power.mean()
    assert np.argmax(power) / noise[0].size == pytest.approx(0.29635, abs=2e-5)


def test_charge_is_deferred_a_little_in_every_tap(files: Path) -> None:
    for share, per_transfer in deferred(files):
        # A tenth of a DN of 400 rows' noise in 15,000 DN is 1e-5; flats of CCDs: 1e-7 to 1e-5.
        assert share > 1e-4
        assert 1e-7 < per_transfer < 1e-5


def test_ten_seconds_more_of_dark_add_a_fifth_of_a_dn(files: Path) -> None:
    growth = dark_growth(files.parent / "dark_current")
    # A tap's 14,000 blank pixels of 4 DN: 0.034 DN a frame, 0.05 for two.
    assert np.all(np.array(growth) > 0.0)
    assert abs(np.mean(growth) / 0.23 - 1.0) < 4.0 * 0.05 / np.sqrt(4) / 0.23
