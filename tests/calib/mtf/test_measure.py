"""From images to the answer: what the bench gets wrong is corrected within its bars, or named."""

import numpy as np
import pytest
from numpy.random import default_rng

from calib.mtf.answer import answer
from calib.mtf.findings import stage_outliers, stage_rms_um, warnings
from calib.mtf.geometry import Alignment
from calib.mtf.grating.grating import Grating
from calib.mtf.measure import Measurement, measure
from calib.mtf.result import TransferResult
from calib.mtf.scan_images import ScanImages
from calib.mtf.simulation.detector import DetectorNoise
from calib.mtf.simulation.response import centred
from calib.mtf.simulation.shapes import square
from tests.calib.mtf.simulated import (
    ORDERS_24,
    ORDERS_48,
    PAPER,
    QUIET,
    Case,
    Scores,
    misaligned,
    record,
)

PIXEL = square(25.0, 0.5)
"""First zero at 1/pitch = 40/mm, as Section 7 finds it."""
UNEVEN = DetectorNoise(shot_noise=True, gain_std=0.01, averaged=100)


def z_scores(case: Case, found: Measurement) -> np.ndarray:
    """Of the transfer function's real part where it is valid."""
    axis = found.frequency_per_um
    values = found.transfer.at(axis, axis)
    fy, fx = np.meshgrid(axis, axis, indexing="ij")
    error = (values.transfer - centred(case.bench.response, fx, fy)).real
    known = values.valid & (values.real_std > 1e-6)
    return error[known] / values.real_std[known]


def shift_z(case: Case, found: Measurement) -> np.ndarray:
    away = found.grating.harmonics.shortest(found.shift_um - case.shift_um(found.fit))
    return away / np.sqrt(np.diag(found.shift_covariance))


def test_the_paper_s_experiment_finds_the_zero_the_sign_and_bars_that_cover() -> None:
    # Section 7: 24 orders, 9.5°, m/n = 1/6, 4.1 µm, 100 frames averaged; here on 64 × 64 pixels.
    rng = default_rng()
    case = record(rng, (64, 64), response=PIXEL, alignment=misaligned(rng), detector=UNEVEN)
    assert np.degrees(PAPER.tilt_rad) == pytest.approx(9.46, abs=0.01)
    assert PAPER.step_um == pytest.approx(4.11, abs=0.01)
    found = TransferResult(measure(case.scan))
    for zero in found.first_zeros:
        assert abs(zero.value - 40.0) < 4 * zero.std < 0.2
    beyond = found.measurement.transfer.at(np.array([0.060]), np.zeros(1))
    assert beyond.transfer.real[0, 0] < -20 * beyond.real_std[0, 0]
    z = z_scores(case, found.measurement)
    assert (np.abs(z) < 3).mean() > 0.97
    assert np.abs(shift_z(case, found.measurement)).max() < 5


def test_a_tilt_and_stage_errors_are_corrected_and_told() -> None:
    rng = default_rng()
    stage = rng.normal(scale=0.1, size=(37, 2))
    bench = Alignment(np.array([12.0, 30.0]), 0.0, np.radians(0.1), stage)
    case = record(rng, response=PIXEL, alignment=bench, detector=UNEVEN)
    found = measure(case.scan)
    assert (np.abs(z_scores(case, found)) < 3).mean() > 0.97
    tilt, std = found.fit.tilt_rad
    assert abs(tilt - np.radians(0.1)) < 5 * std
    told = " ".join(warnings(found))
    assert "tilted by +0.1000°" in told
    true = np.sqrt((case.stage_um(found.fit) ** 2).mean())
    assert stage_rms_um(found) == pytest.approx(true, rel=0.01)
    assert f"stage positions scatter by {stage_rms_um(found):.3f} µm rms: corrected" in told


def test_a_bad_stage_position_is_named_and_corrected() -> None:
    rng = default_rng()
    stage = rng.normal(scale=0.05, size=(37, 2))
    stage[17] = (1.5, -0.2)
    case = record(rng, response=PIXEL, alignment=Alignment(stage_um=stage))
    found = measure(case.scan)
    (bad,) = stage_outliers(found)
    assert bad.position == 17
    for got, true, std in zip(bad.error_um, case.stage_um(found.fit)[17], bad.std_um, strict=True):
        assert abs(got - true) < 6 * std
    named = f"stage position 017 is off by {bad.error_um[0]:+.3f} µm along x"
    assert any(named in each for each in warnings(found))
    assert (np.abs(z_scores(case, found)) < 3).mean() > 0.97


def test_missing_positions_and_a_blind_frame_are_done_without_and_told() -> None:
    rng = default_rng()
    case = record(rng, response=PIXEL, missing=(3, 20))
    images = case.scan.images.copy()
    images[9] = rng.normal(5e4, 1e3, images[9].shape)
    found = measure(ScanImages(PAPER, ORDERS_24, images, case.scan.positions))
    told = warnings(found)
    assert "stage positions 003, 020 were not recorded: done without" in told
    assert f"frame {case.scan.positions[9]:03d} does not show the pattern: left out" in told
    assert (np.abs(z_scores(case, found)) < 3).mean() > 0.97


def test_a_dark_that_was_not_removed_is_told_and_how_much_it_is() -> None:
    case = record(default_rng(), response=PIXEL)
    images = case.scan.images + 500.0  # of a mean of 50,000
    found = measure(ScanImages.whole(PAPER, ORDERS_24, images))
    excess, std = found.psf.mean_excess
    assert abs(excess - 500 / 50_500) < 5 * std
    (told,) = warnings(found)
    assert told.startswith(f"the mean light is {100 * excess:+.2g} %")


def test_a_line_of_pixels_tells_both_directions_since_it_is_tilted() -> None:
    rng = default_rng()
    bench = misaligned(rng)
    case = record(rng, (1, 512), response=PIXEL, alignment=bench, detector=UNEVEN)
    found = measure(case.scan)
    assert (np.abs(z_scores(case, found)) < 3).mean() > 0.97
    zeros = TransferResult(found).first_zeros
    for zero in zeros:
        assert abs(zero.value - 40.0) < 4 * zero.std < 0.4
    assert np.abs(shift_z(case, found)).max() < 5


def test_nyquist_beyond_the_pattern_s_reach_is_unknown() -> None:
    case = record(default_rng(), (80, 80), response=PIXEL, grating=Grating(50, 940.0))
    result = TransferResult(measure(case.scan))
    assert answer(result)["mtf_at_nyquist"] == {"x": None, "y": None, "std": None}
    assert result.reference().mtf_at_nyquist == (None, None)


def test_a_sound_bench_gets_no_warning() -> None:
    found = measure(record(default_rng(), response=PIXEL).scan)
    assert warnings(found) == ()
    assert stage_outliers(found) == ()


@pytest.mark.soak
def test_five_by_five_pixels_on_request() -> None:
    case = record(default_rng(), response=PIXEL, grating=ORDERS_24)
    wide = measure(case.scan, support=5)
    assert wide.psf.basis.side_um == pytest.approx(5.5 * 25)
    assert (np.abs(z_scores(case, wide)) < 3).mean() > 0.95


@pytest.mark.soak
def test_the_shift_s_uncertainty_holds_over_many_recordings() -> None:
    rng, found = default_rng(), []
    for _ in range(200):
        case = record(rng, response=PIXEL, alignment=misaligned(rng), detector=UNEVEN)
        found.append(shift_z(case, measure(case.scan)))
    z = np.array(found)
    assert np.abs(z.mean(axis=0) * np.sqrt(len(z)) / z.std(axis=0)).max() < 4.5
    # The centroid holds what lies between harmonics, for which one pixel is no draw from the prior.
    assert 0.5 < (z**2).mean() < 1 + 4.5 * np.sqrt(1 / len(z))


@pytest.mark.soak
def test_with_48_orders_and_two_pixels_to_an_unknown_everything_scatters_as_stated() -> None:
    rng, harmonics, shifts = default_rng(), Scores(), []
    for _ in range(48):
        case = record(
            rng, (64, 72), grating=ORDERS_48, response=PIXEL, alignment=misaligned(rng),
            detector=UNEVEN,
        )  # fmt: skip
        found = measure(case.scan)
        error = found.fit.transfer - case.transfer(found.fit)
        std = np.sqrt(np.diag(found.fit.transfer_covariance))
        harmonics.add(np.concatenate([error.real, error.imag]) / std)
        shifts.append(shift_z(case, found))
    harmonics.check("harmonics")
    z = np.array(shifts)
    standard_error = np.sqrt(2 / len(z))
    assert (np.abs((z**2).mean(axis=0) - 1) < 4.5 * standard_error).all()
    assert (np.abs(z.mean(axis=0)) < 4.5 / np.sqrt(len(z))).all()


@pytest.mark.soak
def test_section_4_from_images_to_the_transfer_function() -> None:
    case = record(default_rng(), (128, 128), grating=ORDERS_48, detector=QUIET)
    found = measure(case.scan)
    axis = found.frequency_per_um
    values = found.transfer.at(axis, axis)
    fy, fx = np.meshgrid(axis, axis, indexing="ij")
    error = np.abs(values.transfer - centred(case.bench.response, fx, fy))[values.valid]
    assert error.max() < 0.003


@pytest.mark.soak
def test_section_7_at_full_size() -> None:
    rng = default_rng()
    case = record(rng, (256, 320), response=PIXEL, alignment=misaligned(rng), detector=UNEVEN)
    found = TransferResult(measure(case.scan))
    for zero in found.first_zeros:
        assert abs(zero.value - 40.0) < 4 * zero.std < 0.2
    assert (np.abs(z_scores(case, found.measurement)) < 3).mean() > 0.97
