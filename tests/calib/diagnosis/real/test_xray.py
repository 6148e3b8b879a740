"""Ten flats and ten darks of an X-ray camera, quarter counts, one exposure."""

from pathlib import Path

import h5py
import numpy as np
import pytest

from calib.diagnosis.diagnose import Examination, diagnose
from calib.recording.folder_recording import FolderRecording
from examples.real.folders import folder_of_xray

TOOTH = Path(__file__).parents[4].parent / "shared/data/real/xray_flats_darks/tooth.h5"
pytestmark = [
    pytest.mark.shared,
    pytest.mark.skipif(not TOOTH.exists(), reason="needs the reference material"),
]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return folder_of_xray(TOOTH, tmp_path_factory.mktemp("xray") / "a")


@pytest.fixture(scope="module")
def found(folder: Path) -> Examination:
    return diagnose(FolderRecording(folder))


def test_quarters_of_counts_become_whole_ones_without_a_comb(folder: Path) -> None:
    with h5py.File(TOOTH) as file:
        quarters = 4.0 * file["exchange"]["data_dark"][:]
    assert np.array_equal(quarters, np.round(quarters))
    seen = np.bincount(np.load(folder / "frames" / "dark.npy").ravel())
    odd = seen[1::2].sum() / seen.sum()
    # Noise of 3 counts gives odd ones half of 12,800 samples; half to even would give 3 of 8.
    assert abs(odd - 0.5) < 4.0 * 0.5 / np.sqrt(12_800)
    assert abs((np.round(quarters / 4) % 2).mean() - 0.375) < 4.0 * 0.5 / np.sqrt(12_800)


def test_what_one_exposure_leaves_unknown_is_said_with_the_blocks_to_add(
    found: Examination,
) -> None:
    text = found.diagnosis.remarks[0]
    assert "cannot be known" in text
    assert "add flats of 12500, 25000, 50000, 150000 us, and darks at two exposures" in text
    for name in ("nonlinearity", "saturation_knee", "dark_current", "stray_light"):
        assert name in found.diagnosis.not_testable


def test_the_step_of_the_darks_is_told_where_it_is(found: Examination) -> None:
    (text,) = [r for r in found.diagnosis.remarks if "step by" in r]
    assert "In block dark" in text
    assert "after the first 4 of 10" in text
    # As the frames' own means have it: 106.07 counts in the first four, 104.6 in the rest.
    height = float(text.split("step by ")[1].split()[0])
    std = float(text.split("+- ")[1].split()[0])
    assert abs(height - (104.59 - 106.07)) < std / 2


def test_neighbours_and_rows_correlate_and_that_is_seen(found: Examination) -> None:
    evidence = found.evidence
    white = found.model.observed.pooled / evidence.pooled.std
    for kind in ("columns_1", "rows"):
        where = evidence.pooled.places[kind]
        assert white[0, where].sum() / np.sqrt(4) > 8.0
    rest = found.diagnosis.unexplained
    assert rest is not None
    assert rest.where.statistic == "column_covariance"
    assert "flat" in rest.where.blocks


def test_no_name_is_forced_on_what_spreads_and_was_averaged(found: Examination) -> None:
    # Its 2 x 2 pixels and its scintillator are no effect of the catalogue.
    assert found.diagnosis.findings == ()
    assert found.diagnosis.verdict == "unexplained"
