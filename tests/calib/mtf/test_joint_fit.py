"""Is every uncertainty the standard deviation of what happens? Tilt, stage, gain, noise at once.

Pixels, stage errors, tilt, scale, shift and noise are drawn anew for each recording.
"""

from collections import defaultdict

import numpy as np
import pytest
from numpy.random import Generator, default_rng

from calib.errors import NotDeterminedError
from calib.mtf.assembly.coarse_alignment import coarse_alignment
from calib.mtf.assembly.odd_pixels import good_pixels
from calib.mtf.estimation.harmonic_fit import HarmonicFit
from calib.mtf.estimation.joint_fit import joint_fit
from calib.mtf.geometry import Scan
from calib.mtf.scan_images import ScanImages
from calib.mtf.simulation.detector import DetectorNoise
from tests.calib.mtf.simulated import ORDERS_12, ORDERS_24, SMALL, Case, Scores, misaligned, record

SHAPE = (40, 40)
READ_NOISE = DetectorNoise(read_noise_e=400.0)
SHOT_AND_GAIN = DetectorNoise(shot_noise=True, gain_std=0.01)
GAIN_AND_OFFSET = DetectorNoise(gain_std=0.01, offset_std_e=300.0, read_noise_e=100.0)
DETECTORS = [
    pytest.param(READ_NOISE, id="read-noise"),
    pytest.param(SHOT_AND_GAIN, id="shot-noise-and-gain"),
    pytest.param(GAIN_AND_OFFSET, id="gain-and-offset"),
]


def draw(
    rng: Generator, detector: DetectorNoise, shape: tuple[int, int] = SHAPE
) -> tuple[Case, HarmonicFit]:
    case = record(
        rng, shape, scan=SMALL, grating=ORDERS_12, alignment=misaligned(rng, SMALL),
        detector=detector,
    )  # fmt: skip
    return case, joint_fit(case.scan, coarse_alignment(case.scan).alignment)


def cover(
    rng: Generator, detector: DetectorNoise, recordings: int, shape: tuple[int, int] = SHAPE
) -> None:
    scores: dict[str, Scores] = defaultdict(Scores)
    for _ in range(recordings):
        case, fit = draw(rng, detector, shape)
        error = fit.transfer - case.transfer(fit)
        std = np.sqrt(np.diag(fit.transfer_covariance))
        scores["transfer"].add(np.concatenate([error.real, error.imag]) / std)
        alignment = case.bench.alignment
        scores["scale"].add(np.array([(fit.scale[0] - alignment.scale) / fit.scale[1]]))
        scores["tilt"].add(np.array([(fit.tilt_rad[0] - alignment.tilt_rad) / fit.tilt_rad[1]]))
        found, stage_std = fit.stage_um
        scores["stage"].add(((found - case.stage_um(fit)) / stage_std).ravel())
    for name, each in scores.items():
        each.check(name)


@pytest.mark.parametrize("detector", DETECTORS)
def test_z_scores_have_mean_0_and_mean_square_1(detector: DetectorNoise) -> None:
    cover(default_rng(), detector, 24)


@pytest.mark.soak
@pytest.mark.parametrize("detector", DETECTORS)
def test_z_scores_have_mean_0_and_mean_square_1_over_many(detector: DetectorNoise) -> None:
    cover(default_rng(), detector, 300, (80, 80))


def test_gain_scatter_of_one_percent_is_measured_and_costs_nothing_after() -> None:
    rng = default_rng()
    _, clean = draw(rng, DetectorNoise(read_noise_e=100.0))
    _, uneven = draw(rng, DetectorNoise(read_noise_e=100.0, gain_std=0.01))
    standard_error = 0.01 / np.sqrt(2 * SHAPE[0] * SHAPE[1])
    assert abs(uneven.gain_std - 0.01) < 5 * standard_error
    assert clean.gain_std < 0.001
    before, after = (np.sqrt(np.trace(fit.transfer_covariance)) for fit in (clean, uneven))
    # Two of a pixel's ten signals go into its own gain and offset; unsorted, it cost 6 times.
    assert after < 1.5 * before


def test_noise_beside_gain_scatter_is_not_what_the_plain_fit_left() -> None:
    # 225 pixels for 105 unknowns: the plain fit takes much of the gains for the pattern's.
    rng, noise_e, recordings = default_rng(), 20.0, 6
    detector, z = DetectorNoise(read_noise_e=noise_e, gain_std=0.01), []
    for _ in range(recordings):
        _, fit = draw(rng, detector, (15, 15))
        # A pixel's ten signals less its own gain and offset; the unknowns' share is 105 in 1,800.
        freedom = (SMALL.positions - 2) * fit.good.sum()
        share = 1 - fit.state.layout.size / freedom
        z.append(((fit.noise / noise_e) ** 2 / share - 1) * np.sqrt(freedom / 2))
    # One step of generalised least squares left 2.5 times the noise.
    assert abs(np.mean(z)) < 5 / np.sqrt(recordings)


def test_a_pixel_s_gain_is_found_pixel_by_pixel() -> None:
    detector = DetectorNoise(gain_std=0.01, read_noise_e=200.0)
    truth, _ = detector.maps(SHAPE, default_rng(11))
    case = record(default_rng(11), SHAPE, scan=SMALL, grating=ORDERS_12, detector=detector)
    fit = joint_fit(case.scan, coarse_alignment(case.scan).alignment)
    error = fit.gain - (truth / truth.mean() - 1)
    images = case.scan.images
    own_noise = 200.0 / np.sqrt(
        (images**2).sum(0)
    )  # were a pixel fitted alone and its offset known
    assert (error**2).mean() < 1.5 * (own_noise**2).mean()
    assert (error**2).mean() < 0.05 * (fit.gain**2).mean()


def test_light_that_changes_between_frames_is_estimated() -> None:
    rng = default_rng()
    case = record(rng, SHAPE, scan=SMALL, grating=ORDERS_12, detector=READ_NOISE)
    level = 1 + 0.03 * rng.normal(size=SMALL.positions)
    images = case.scan.images * level[:, None, None]
    fit = joint_fit(
        ScanImages.whole(SMALL, ORDERS_12, images), coarse_alignment(case.scan).alignment
    )
    at = fit.state.layout.of_frames(2)
    std = np.sqrt(np.diag(fit.covariance)[at]).mean()
    found, true = fit.state.level / fit.state.level.mean(), level / level.mean()
    assert np.abs(found - true).max() < 5 * std < 0.01
    z = (fit.transfer - case.transfer(fit)).real / np.sqrt(np.diag(fit.transfer_covariance))[
        : len(fit.transfer)
    ]
    assert np.abs(z).max() < 5


def test_gain_scatter_makes_no_pixel_odd() -> None:
    rng = default_rng()
    model = record(rng, (200, 200), scan=SMALL, grating=ORDERS_12).bench.light()
    scatter, noise = 0.01 * rng.normal(size=(200, 200)), 1e-3 * rng.normal(size=model.shape)
    # 5.4 standard deviations: 0.003 of 40,000 pixels by chance
    assert good_pixels(scatter * model + noise, model).all()


@pytest.mark.parametrize("value", [0.0, 65535.0, 4e6])
def test_odd_pixels_are_left_out_and_do_no_harm(value: float) -> None:
    rng = default_rng()
    case = record(rng, SHAPE, scan=SMALL, grating=ORDERS_12, detector=READ_NOISE)
    images = case.scan.images.copy()
    images[:, 3, 4], images[2, 30, 31] = value, value
    fit = joint_fit(
        ScanImages.whole(SMALL, ORDERS_12, images), coarse_alignment(case.scan).alignment
    )
    assert set(map(tuple, np.argwhere(~fit.good).tolist())) == {(3, 4), (30, 31)}
    error = fit.transfer - case.transfer(fit)
    z = np.concatenate([error.real, error.imag]) / np.sqrt(np.diag(fit.transfer_covariance))
    assert np.abs(z).max() < 5.5


def test_harmonics_that_alias_onto_each_other_are_refused() -> None:
    rng = default_rng()
    straight = Scan(25.0, 0, 1)  # one position, no tilt: frequencies are known modulo 1/pitch alone
    case = record(rng, (20, 20), scan=straight, grating=ORDERS_24)
    with pytest.raises(NotDeterminedError, match="alias") as refused:
        joint_fit(case.scan, coarse_alignment(case.scan).alignment)
    assert refused.value.code == "aliased"


def test_a_start_far_from_the_truth_is_said_not_to_settle_or_settles_nowhere_else() -> None:
    rng = default_rng()
    case, _ = draw(rng, READ_NOISE)
    again = joint_fit(case.scan, coarse_alignment(case.scan).alignment)
    nudged = again.state.sampling.alignment
    found = joint_fit(case.scan, nudged)
    std = np.sqrt(np.diag(found.transfer_covariance)).mean()
    assert np.abs(found.transfer - again.transfer).max() < 0.1 * std
