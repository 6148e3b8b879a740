"""An offset that all columns share is no error of the scale, and errs together with DN0."""

import numpy as np
import pytest

from calib.radiometric.coefficients.coefficient_set import CoefficientSet
from calib.radiometric.coefficients.provenance import Provenance
from calib.radiometric.correction.apply import Correction
from calib.radiometric.estimation.common_offset import CommonOffset, common_offset
from calib.radiometric.estimation.from_statistics import determine
from tests.calib.radiometric.simulated import Bench, draw

SWEEP = tuple(np.linspace(50.0, 500.0, 12))
DARK_EDGE = Bench(
    certificate=0.0, level_error=0.0, line_noise_dn=4.0, exposures=SWEEP, darks=24, fall=0.9
)


def found(bench: Bench, rng: np.random.Generator) -> CoefficientSet:
    statistics = draw(bench, rng).statistics
    return determine(statistics, bench.header(), Provenance("0" * 64)).coefficients


@pytest.mark.parametrize("levels", [(), (1, 2, 4)], ids=["one-level", "levels"])
def test_no_columns_covariance_has_a_negative_eigenvalue(levels: tuple[int, ...]) -> None:
    bench = Bench(**{**vars(DARK_EDGE), "levels": levels})
    for rng in np.random.default_rng(1).spawn(10):
        c = found(bench, rng)
        slope2 = c.slope_std**2 + (c.slope * c.scale_relative_std) ** 2
        assert (c.offset_slope_covariance**2 < c.dark_offset_dn_std**2 * slope2)[c.valid].all()
        terms = Correction(c, 400.0, camera=bench.header().camera).terms
        for signal_dn in np.linspace(-50.0, 4095.0, 100):
            variance = terms.coefficient_variance_dn2(np.full(bench.n, signal_dn))
            assert (variance[c.valid] > 0).all()


def test_of_one_level_it_is_the_slopes_alone() -> None:
    """All slopes are off by the same DN/µs, the dim columns by the larger share; not the scale."""
    x = np.arange(1.0, 9.0)
    design = np.column_stack([np.ones(8), x])
    estimator, weight = np.linalg.pinv(design), np.ones(8)
    offset = CommonOffset(common_offset(design, weight, estimator, 0.25 * np.eye(8)), 3.0)
    scale, slope = offset.on_scale(np.zeros(0)), np.array([0.3, 1.5, 3.6])
    slope_std = 0.5 / np.sqrt(((x - x.mean()) ** 2).sum())
    assert scale.scale_std == pytest.approx(0.0, abs=1e-12)
    np.testing.assert_allclose(scale.slope_relative_std(slope), slope_std / slope)
    np.testing.assert_allclose(offset.slope_std, slope_std)


def test_a_column_of_the_mean_slope_errs_as_the_joint_fit_does() -> None:
    rng = np.random.default_rng(3)
    x, group = np.arange(1.0, 9.0), np.array([0, 0, 0, 0, 0, 1, 2, 2])
    by_level = [np.where(group == g, 3.0 * x, 0.0) for g in (1, 2)]
    design = np.column_stack([np.ones(8), x, *by_level])
    weight, error = rng.uniform(0.5, 2.0, 8), rng.standard_normal((8, 8))
    root = np.sqrt(weight)
    estimator = np.linalg.pinv(design * root[:, None]) * root
    blocks = error @ error.T
    offset = CommonOffset(common_offset(design, weight, estimator, blocks), 3.0)
    np.testing.assert_allclose(offset.of_mean_column, estimator @ blocks @ estimator.T, rtol=1e-9)
    # With c by the levels' weights 0.2, 0.5 and 0.3, at r = 1, 2 and 3:
    by_level_ln = np.array([0.5 / 2.0, 0.3 / 3.0])
    row = np.array([0.0, 1 / 3.0, *by_level_ln]) @ estimator
    scale, one = offset.on_scale(by_level_ln), np.full(1, 3.0)
    total = scale.slope_relative_std(one) ** 2 + scale.scale_std**2
    np.testing.assert_allclose(total, row @ blocks @ row, rtol=1e-9)
    np.testing.assert_allclose(
        scale.offset_covariance_dn(one), estimator[0] @ blocks @ row, rtol=1e-9
    )
    np.testing.assert_allclose(
        offset.offset_variance(one), estimator[0] @ blocks @ estimator[0], rtol=1e-9
    )
