"""Cosmic rays come at their rate, straight, and leave the charge of their law."""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import stats

from calib.forward.effects.cosmic_rays import CosmicRays
from calib.forward.effects.exposure_offset import ExposureOffset
from tests.calib.forward.small_sensors import DEMO, at

RNG = np.random.default_rng(0)
SEEDS = pytest.mark.parametrize("seed", [1, 2, 3])


def tracks(sample: tuple[int, ...], n: int, seed: int, **given: float) -> NDArray[np.float64]:
    """What cosmic rays leave in n empty lines or frames of 1 ms."""
    rays, empty = CosmicRays(**given), np.zeros((n, *sample))
    return np.asarray(rays.apply(empty, at(n, exposure_us=1000.0), np.random.default_rng(seed)))


@pytest.mark.parametrize("sample", [(2000,), (40, 50)], ids=["line", "frame"])
@SEEDS
def test_cosmic_rays_hit_at_their_rate_and_leave_moyals_charge(
    sample: tuple[int, ...], seed: int
) -> None:
    left = tracks(sample, 500, seed, per_pixel_s=2.0, electrons=900.0, length_pixels=1.0)
    hits = left[left > 0]
    wanted = 2.0 * 1e-3 * left.size
    # Two tracks in one pixel count as one: 1 in 1000 of them.
    assert abs(hits.size - wanted * (1 - 1e-3)) < 5 * np.sqrt(wanted)
    apart = hits[hits < 3000.0]
    law = stats.moyal(loc=900.0, scale=0.14 * 900.0)
    cut = law.cdf(3000.0)
    assert stats.kstest(apart, lambda x: law.cdf(x) / cut).pvalue > 1e-6
    lines = (left > 0).reshape(500, -1).sum(axis=1)
    assert abs(lines.var() / lines.mean() - 1) < 5 * np.sqrt(2 / 500)


@pytest.mark.parametrize(("sample", "mean_length"), [((2000,), 5.0), ((90, 90), 5.0)])
@SEEDS
def test_tracks_leave_their_charge_in_as_many_pixels_as_they_cross(
    sample: tuple[int, ...], mean_length: float, seed: int
) -> None:
    rate, n = 1.0, 300
    left = tracks(sample, n, seed, per_pixel_s=rate, length_pixels=mean_length)
    n_tracks = rate * 1e-3 * left.size
    # The axis that a track follows more closely moves on by 1, the other by tan of 0 to 45 degrees.
    other_axis = (1 + np.log(2) / 2 / (np.pi / 4)) / 2
    # A track of length l loses l (l - 1) / 2 pixels over its start's n places, per unit of step.
    steps = [1.0 / 2000] if len(sample) == 1 else [other_axis / 90] * 2
    crossed = mean_length - mean_length * (mean_length - 1) * sum(steps)
    law = stats.moyal(loc=1000.0, scale=140.0)
    wanted = n_tracks * crossed * law.mean()
    # A track's charge varies with its length, var + mean^2 = 2 l^2 - l, and pixel by pixel.
    per_track = (2 * mean_length**2 - mean_length) * law.mean() ** 2 + mean_length * law.var()
    assert abs(left.sum() - wanted) < 5 * np.sqrt(n_tracks * per_track) + 0.003 * wanted


def test_a_track_is_straight_and_lies_in_one_line_or_frame() -> None:
    found = 0
    for seed in range(1000):
        for sample in ((400,), (60, 60)):
            # One draw in 200 has a track, so two in one are not to be met.
            rate = 1.0 / float(np.prod(sample))
            hit = np.argwhere(tracks(sample, 5, seed, per_pixel_s=rate, length_pixels=25.0) > 0)
            if len(hit) < 5:
                continue
            found += 1
            assert len(np.unique(hit[:, 0])) == 1
            assert np.ptp(hit[:, 1:], axis=0).max() == len(hit) - 1
            # Rounding to pixels moves a point off the line by 1/sqrt(2) at most.
            across = np.linalg.svd(hit[:, 1:] - hit[:, 1:].mean(axis=0), compute_uv=False)[1:]
            assert np.all(across < np.sqrt(len(hit) / 2))
    assert found > 3


def test_cosmic_rays_gather_for_as_long_as_the_exposure_really_lasts() -> None:
    rays = DEMO.with_effect(CosmicRays(per_pixel_s=50.0, electrons=20_000.0, length_pixels=1.0))
    shifted = rays.with_effect(ExposureOffset(offset_us=50.0))
    n = 200
    for model, exposure_us in ((rays, 50.0), (shifted, 100.0)):
        dn = model.draw(at(n, capped=True), np.random.default_rng(2)).dn
        hits = int((dn > 500).sum())
        wanted = 50.0 * exposure_us * 1e-6 * dn.size
        assert abs(hits - wanted) < 5 * np.sqrt(wanted) + wanted * 0.003
