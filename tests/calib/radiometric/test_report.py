"""The report shows the calibration it was given, whole, and needs nothing but itself."""

import re
from pathlib import Path

import numpy as np
import pytest

from calib.errors import DarkflatError
from calib.forward.model import Model
from calib.radiometric.calibrate import calibrate
from calib.radiometric.calibration import Calibration
from calib.radiometric.report.page import CAPTIONS, figures, write_report
from calib.recording.block_statistics import RecordingStatistics
from calib.recording.header import Block
from calib.recording.statistics import column_statistics
from calib.report.style import unit_text
from tests.calib.radiometric.in_memory import InMemory, record

LINES = 32


def plan() -> list[Block]:
    """Ten flats and five darks of the demo camera, none of them clipped."""
    sweep = [("flat", t, 2) for t in (20.0, 40.0, 60.0, 80.0, 90.0)]
    levels = [("flat", 60.0, level) for level in (1, 2, 3, 4, 5)]
    darks = [("dark", t, 0) for t in (20.0, 40.0, 60.0, 80.0, 90.0)]
    return [
        Block(block=f"{k:03d}", kind=kind, exposure_us=t, level=level, lines=LINES)
        for k, (kind, t, level) in enumerate((*darks, *sweep, *levels))
    ]


@pytest.fixture(scope="module")
def recording() -> InMemory:
    return record(Model.preset("demo"), plan(), np.random.default_rng(), LINES)


@pytest.fixture(scope="module")
def calibration(recording: InMemory) -> Calibration:
    return calibrate(recording)


@pytest.fixture(scope="module")
def statistics(recording: InMemory) -> RecordingStatistics:
    return column_statistics(recording, held_out_every=8)


@pytest.fixture(scope="module")
def page(
    tmp_path_factory: pytest.TempPathFactory,
    recording: InMemory,
    calibration: Calibration,
    statistics: RecordingStatistics,
) -> str:
    path = tmp_path_factory.mktemp("report") / "report.html"
    write_report(path, recording, calibration, statistics)
    assert list(path.parent.iterdir()) == [path]
    return path.read_text("utf-8")


def test_every_figure_is_there_with_its_caption(page: str) -> None:
    assert page.count("<svg") == len(CAPTIONS)
    assert all(caption.replace("'", "&#39;") in page for caption in CAPTIONS.values())


def test_nothing_is_fetched(page: str) -> None:
    fetched = re.findall(r'(?:src|href)="(?!#|data:)([^"]*)"', page)
    assert fetched == []
    assert "<script" not in page
    assert "@import" not in page


def test_it_names_the_set_and_the_recording(
    page: str, recording: InMemory, calibration: Calibration
) -> None:
    assert calibration.coefficients.id in page
    assert recording.digest() in page


def test_every_warning_and_budget_row_is_said(page: str, calibration: Calibration) -> None:
    plain = page.replace("&#39;", "'").replace("&#34;", '"')
    assert all(warning in plain for warning in calibration.warnings)
    assert all(row.quantity in plain for row in calibration.coefficients.budget.rows)


def test_the_curves_are_the_coefficients(
    recording: InMemory, calibration: Calibration, statistics: RecordingStatistics
) -> None:
    drawn = {f.name: f.figure for f in figures(recording, calibration, statistics)}
    found = calibration.coefficients
    curve = drawn["responsivity"].axes[0].lines[0].get_ydata()
    np.testing.assert_array_equal(curve, np.where(found.valid, found.responsivity, np.nan))
    profile = drawn["slope"].axes[0].lines[1].get_ydata()
    np.testing.assert_array_equal(profile, calibration.figures.profile_slope)


def test_residuals_of_a_sound_recording_have_unit_spread(
    recording: InMemory, calibration: Calibration, statistics: RecordingStatistics
) -> None:
    drawn = {f.name: f.figure for f in figures(recording, calibration, statistics)}
    image = np.asarray(drawn["residuals"].axes[0].images[0].get_array())
    flat = np.array([b.block.kind == "flat" for b in statistics.fit])
    # A column's line takes 2 of its 10 flats' freedoms, a block's level 1 of 1,024; the variance
    # of 28 lines makes t of 27 freedoms out of normal residuals: spread sqrt(27/25).
    expected = np.sqrt((1 - 2 / 10) * 27 / 25)
    free = 0.8 * image[flat].size
    assert np.std(image[flat]) == pytest.approx(expected, abs=4 * expected / np.sqrt(2 * free))
    # The darks' own mean takes one of their five freedoms, and the variance counts it already.
    darks, free = np.std(image[~flat]), 0.8 * image[~flat].size
    expected = np.sqrt(27 / 25)
    assert darks == pytest.approx(expected, abs=4 * expected / np.sqrt(2 * free))


def test_residuals_of_darks_do_not_show_the_intercepts_error(
    recording: InMemory, calibration: Calibration, statistics: RecordingStatistics
) -> None:
    drawn = {f.name: f.figure for f in figures(recording, calibration, statistics)}
    image = np.asarray(drawn["residuals"].axes[0].images[0].get_array())
    darks = image[[b.block.kind == "dark" for b in statistics.fit]]
    # Rows about their own mean have the correlation −1/(n − 1), those about DN0 a positive one.
    found = np.corrcoef(darks)[np.triu_indices(len(darks), 1)]
    assert np.mean(found) == pytest.approx(-1 / 4, abs=4 / np.sqrt(len(found) * image.shape[1]))


def test_values_have_the_digits_of_their_uncertainty_and_units_are_printed(page: str) -> None:
    fact = re.search(r"Responsivity at the axis</th><td[^>]*>([\d.]+) ± ([\d.]+) ([^<]*)<", page)
    assert fact is not None
    value, std, unit = fact.groups()
    assert len(value.partition(".")[2]) == len(std.partition(".")[2])
    assert len(std.lstrip("0.").replace(".", "")) == 2
    assert "-1" not in unit
    assert unit_text("W m-2 sr-1 nm-1") == "W m⁻² sr⁻¹ nm⁻¹"
    assert unit_text("1") == "1"


def test_a_masked_column_is_a_gap(
    recording: InMemory, calibration: Calibration, statistics: RecordingStatistics
) -> None:
    stuck = {b: tuple(_stick(f) for f in s) for b, s in recording.stretches.items()}
    broken = InMemory(recording.header, stuck)
    drawn = figures(broken, calibrate(broken), statistics)
    curve = next(f for f in drawn if f.name == "responsivity").figure.axes[0].lines[0]
    assert np.isnan(np.asarray(curve.get_ydata())[100])


def _stick(frame: np.ndarray) -> np.ndarray:
    stuck = frame.copy()
    stuck[:, 100] = 70
    return stuck


def test_a_page_that_cannot_be_written_leaves_nothing(
    tmp_path: Path,
    recording: InMemory,
    calibration: Calibration,
    statistics: RecordingStatistics,
) -> None:
    (tmp_path / "taken").mkdir()
    before = list(tmp_path.iterdir())
    for path in (tmp_path / "nowhere" / "r.html", tmp_path / "taken"):
        with pytest.raises(DarkflatError, match=re.escape(str(path))) as error:
            write_report(path, recording, calibration, statistics)
        assert error.value.code == "cannot-write"
        assert list(tmp_path.iterdir()) == before
