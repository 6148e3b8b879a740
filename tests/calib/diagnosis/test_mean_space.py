import numpy as np

from calib.diagnosis.evidence.mean_space import mean_space


def test_products_are_those_of_the_full_covariance_without_what_pixels_absorb() -> None:
    rng = np.random.default_rng()
    blocks, pixels = 5, 6
    weight = rng.uniform(0.5, 2.0, (blocks, pixels))
    weight[1, 2] = 0.0
    dose = rng.uniform(0.0, 3.0, blocks)
    modes, where, variance = (
        rng.normal(size=(4, pixels)),
        np.array([0, 2, 2, 4]),
        rng.uniform(0.1, 2, 4),
    )
    space = mean_space(weight, (np.ones(blocks), dose), modes, where, variance)
    used = weight.ravel() > 0
    covariance = np.diag(1.0 / np.where(used, weight.ravel(), 1.0) ** 2)
    for mode, b, v in zip(modes, where, variance, strict=True):
        full = np.zeros((blocks, pixels))
        full[b] = mode
        covariance += v * np.outer(full.ravel(), full.ravel())
    inverse = np.linalg.inv(covariance[np.ix_(used, used)])
    nuisance = [np.kron(r, e) for r in (np.ones(blocks), dose) for e in np.eye(pixels)]
    design = np.array(nuisance).T[used]
    projected = (
        inverse
        - inverse @ design @ np.linalg.pinv(design.T @ inverse @ design) @ design.T @ inverse
    )
    one, other = rng.normal(size=(2, blocks, pixels))
    found = space.product(space.project(one), space.project(other))
    np.testing.assert_allclose(
        found, one.ravel()[used] @ projected @ other.ravel()[used], rtol=1e-8
    )
    assert space.degrees_of_freedom == used.sum() - 2 * pixels
