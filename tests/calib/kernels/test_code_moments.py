"""Moments from the chances of codes, against a plain twin that sorts and masks."""

import numpy as np
import pytest
from numpy.typing import NDArray

from calib.kernels.code_moments import Limits, code_moments

Floats = NDArray[np.float64]

LIMITS = Limits(
    cut=6.0,
    hardly=1e-5,
    near=0.3,
    near_share=1e-3,
    beside=3.0,
    far=6.0,
    flip=3.0,
    very_far=8.0,
)
FLIPS = 12


def twin(codes: Floats, chance: Floats, sigma: Floats) -> tuple[Floats, Floats]:
    cut = (LIMITS.cut * sigma + 1.0)[:, None]
    mean = (chance * codes).sum(axis=1) / chance.sum(axis=1)
    jumps = (chance * (np.abs(codes - mean[:, None]) > cut)).sum(axis=1) > LIMITS.hardly
    order = np.argsort(codes, axis=1)
    upto = np.cumsum(np.take_along_axis(chance, order, axis=1), axis=1)
    middle = np.argmax(upto >= 0.5 * upto[:, -1:], axis=1)[:, None]
    median = np.take_along_axis(codes, np.take_along_axis(order, middle, axis=1), axis=1)
    near = np.where(np.abs(codes - median) <= cut, chance, 0.0)
    mean = np.where(jumps, (near * codes).sum(axis=1) / near.sum(axis=1), mean)
    off = codes - mean[:, None]
    size, wide = np.abs(off), sigma[:, None]
    within = np.where(size > cut, 0.0, chance)
    moments = [
        mean + (within * off).sum(axis=1),
        (within * off**2).sum(axis=1),
        (within * off**4).sum(axis=1),
        (chance * (size > cut)).sum(axis=1),
        (chance * (np.abs(size / cut - 1.0) < LIMITS.near)).sum(axis=1) > LIMITS.near_share,
        (chance * (off > LIMITS.beside * wide)).sum(axis=1),
    ]
    counted = np.where((size > cut) & (size > LIMITS.far * wide), chance, 0.0)
    bit = np.clip(np.rint(np.log2(np.maximum(size, 1.0))), 0, FLIPS - 1).astype(int)
    flipped = (np.abs(size - 2.0**bit) < LIMITS.flip * wide) & (size > LIMITS.very_far * wide)
    kind = np.where(flipped, 2 + bit + FLIPS * (off <= 0), 1 * (off <= 0))
    far = [
        [row[of == k].sum() for k in range(2 + 2 * FLIPS)]
        for row, of in zip(counted, kind, strict=True)
    ]
    return np.stack([np.asarray(m, float) for m in moments], axis=1), np.array(far)


@pytest.mark.parametrize("jumping", [0.0, 1e-6, 0.01, 0.4, 0.7])
def test_moments_are_those_of_a_plain_twin(jumping: float) -> None:
    rng = np.random.default_rng()
    codes = np.arange(-60.0, 61.0) + rng.integers(100, 3000, (20, 1))
    chance = rng.exponential(1.0, codes.shape) * np.exp(-0.5 * (np.arange(-60, 61) / 9.0) ** 2)
    chance /= chance.sum(axis=1, keepdims=True)
    jumps = codes + rng.choice([-64.0, 64.0, 1024.0, 7.0], codes.shape)
    codes = np.concatenate([codes, jumps], axis=1)
    chance = np.concatenate([(1.0 - jumping) * chance, jumping * chance], axis=1)
    sigma = rng.uniform(5.0, 12.0, 20)
    moments, far = code_moments(codes, chance, sigma, LIMITS, FLIPS)
    expected, far_expected = twin(codes, chance, sigma)
    assert jumping < 0.01 or far_expected.sum() > 0.1 * jumping
    # Sums of 242 terms; a mean of 3,000 DN loses 4e-13 DN, of which squares are taken to 100 DN.
    np.testing.assert_allclose(moments, expected, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(far, far_expected, rtol=1e-9, atol=1e-15)
