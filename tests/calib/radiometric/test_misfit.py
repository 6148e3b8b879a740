"""What moves a column's or a block's means together is told from a misfit of the lines."""

from dataclasses import replace

import numpy as np
import pytest

from calib.forward.effects.dark_current import DarkCurrent
from calib.forward.model import Model
from calib.radiometric.calibrate import calibrate
from calib.radiometric.calibration import Calibration
from calib.radiometric.coefficients.provenance import Provenance
from calib.radiometric.estimation.from_statistics import Determined, determine
from calib.recording.header import Block
from tests.calib.radiometric.in_memory import record
from tests.calib.radiometric.simulated import Bench, draw

LINES = 128
EXPOSURES_US = (10.0, 30.0, 50.0, 70.0)
LEVELS = (1, 2, 4, 6)


def factorial() -> list[Block]:
    """Every level at every exposure, and a dark of each."""
    kinds = [("dark", t, 0) for t in EXPOSURES_US]
    kinds += [("flat", t, level) for t in EXPOSURES_US for level in LEVELS]
    return [
        Block(block=f"{k:03d}", kind=kind, exposure_us=t, level=level, lines=LINES)
        for k, (kind, t, level) in enumerate(kinds)
    ]


def calibrated(dark_current: DarkCurrent | None) -> Calibration:
    model = Model.preset("demo")
    if dark_current is not None:
        model = model.with_effect(dark_current)
    return calibrate(record(model, factorial(), np.random.default_rng(), LINES))


@pytest.mark.parametrize(
    "current",
    [None, DarkCurrent(2.0, 0.3), DarkCurrent(8.0, 1.0)],
    ids=["no-dark-current", "dark-current", "much-dark-current"],
)
def test_chi_squared_is_one_whatever_the_dark_current(current: DarkCurrent | None) -> None:
    n = 8
    found = [calibrated(current).coefficients for _ in range(n)]
    chi2 = [c.reduced_chi_squared or 0.0 for c in found]
    freedom = found[0].n_columns * (len(EXPOSURES_US) * len(LEVELS) - 2) - len(LEVELS) + 1
    # The weights' own uncertainty is common to all cells of a recording: 0.1 % beyond chance.
    assert np.mean(chi2) == pytest.approx(1.0, abs=4 * np.sqrt(2 / freedom / n) + 0.004)


def test_capped_darks_are_stated_as_they_would_be_at_exposure_0() -> None:
    calibration = calibrated(DarkCurrent(2.0, 0.3))
    answer = calibration.answer()
    dark, difference = answer["mean_dark_offset_dn"], answer["dark_offset_difference_dn"]
    assert dark["capped"] - dark["regression"] == pytest.approx(difference["value"], abs=0.01)
    grown = 2.0 * 0.15 * np.mean(EXPOSURES_US)
    assert dark["capped_raw"] - dark["capped"] == pytest.approx(grown, rel=0.05)


def test_without_dark_current_capped_darks_are_stated_as_they_are() -> None:
    calibration = calibrated(None)
    dark = calibration.answer()["mean_dark_offset_dn"]
    drift_std = np.median(calibration.coefficients.dark_current_dn_per_us_std)
    away = abs(dark["capped"] - dark["capped_raw"])
    assert away < 4 * drift_std * np.mean(EXPOSURES_US)
    assert drift_std * np.mean(EXPOSURES_US) < 0.1


def determined(bench: Bench) -> Determined:
    statistics = draw(bench, np.random.default_rng()).statistics
    return determine(statistics, bench.header(), Provenance("0" * 64))


LONG = Bench(exposures=tuple(np.linspace(50.0, 500.0, 12)))


def test_a_source_that_wanders_is_said_with_its_size() -> None:
    found = determined(replace(LONG, unrest=0.002))
    (said,) = (text for text in found.warnings if "wandered by" in text)
    assert f"{100 * found.figures.source_unrest:.2g} %" in said
    assert found.figures.source_unrest == pytest.approx(0.002, rel=4 / np.sqrt(2 * 11))


@pytest.mark.parametrize(
    "bench",
    [LONG, replace(LONG, dark_current=0.05, darks=5)],
    ids=["steady", "dark-current"],
)
def test_of_a_steady_source_nothing_is_said(bench: Bench) -> None:
    for _ in range(20):
        said = " ".join(determined(bench).warnings)
        assert "wandered" not in said
        assert "do not fit" not in said


def test_no_sentence_names_a_command_that_is_not_there() -> None:
    found = determined(replace(LONG, unrest=0.01))
    said = " ".join(found.warnings)
    assert "do not fit within the noise" in said
    assert "diagnose" not in said
