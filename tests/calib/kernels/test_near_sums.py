import numpy as np

from calib.kernels.near_sums import near_sums


def test_sums_are_those_of_plain_numpy() -> None:
    rng = np.random.default_rng()
    samples = rng.integers(0, 4096, (40, 30)).astype(np.uint16)
    middle, limit = rng.uniform(1000.0, 3000.0, 30), rng.uniform(0.0, 2000.0, 30)
    off = samples - middle
    near = np.abs(off) <= limit
    twin = np.stack([near.sum(axis=0), (near * off).sum(axis=0), (near * off**2).sum(axis=0)])
    # Sums of 40 squares of 2,000 at most.
    np.testing.assert_allclose(near_sums(samples, middle, limit), twin, rtol=1e-12, atol=1e-6)
