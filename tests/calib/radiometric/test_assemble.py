"""A single error of all columns makes DN0 and slope err together, to the full."""

import numpy as np
import pytest

from calib.radiometric.estimation.assemble import LineVariances, coefficient_columns
from calib.radiometric.estimation.block_noise import BlockNoise
from calib.radiometric.estimation.common_mode import CommonMode
from calib.radiometric.estimation.common_offset import CommonOffset
from calib.radiometric.estimation.normalised_profile import Vignette
from calib.radiometric.estimation.radiance_table import LevelGroups
from calib.radiometric.estimation.scale import radiance_scale

SLOPE = np.array([0.5, 2.0, 3.0])
NOTHING = np.zeros(3)
LENS = Vignette(SLOPE / 3.0, NOTHING, NOTHING, NOTHING, 3.0, 2.0, 1.0, NOTHING)


@pytest.mark.parametrize("kind", ["source", "offset"])
def test_dn0_and_slope_are_correlated_to_the_full(kind: str) -> None:
    """Of one error, DN0 falls by 3 DN where the mean slope of 2 DN/µs rises by 0.02."""
    error = np.array([-3.0, 0.02])
    by_source = np.outer(error, error) if kind == "source" else np.zeros((2, 2))
    by_line = np.array([*error, 0.0, 0.0]) * (kind == "offset")
    shared = CommonMode(
        source_unrest=0.0,
        unrest_sigma=0.0,
        offset_noise=BlockNoise(0.0, 9, 0.0),
        block_variance_dn2=np.zeros(0),
        freedom=9,
        mean_slope=2.0,
        by_source=by_source,
        offset=CommonOffset(np.outer(by_line, by_line), 2.0),
        groups=(),
    )
    one_level = LevelGroups(np.zeros(1, np.intp), np.ones(1), np.array([10.0]))
    scale = radiance_scale(one_level, np.ones(1), shared, 0.0)
    scale_std = float(np.hypot(scale.by_source_unrest, scale.by_offset.scale_std))
    found = coefficient_columns(
        NOTHING,
        SLOPE,
        variances=LineVariances(NOTHING, NOTHING, NOTHING),
        vignette=LENS,
        shared=shared,
        scale=scale,
        scale_std=scale_std,
    )
    # The source's error is in proportion to the slope, an offset's is the same for all columns.
    share = SLOPE / 2.0 if kind == "source" else np.ones(3)
    slope_std = np.hypot(found["slope_std"], found["slope"] * scale_std)
    np.testing.assert_allclose(found["dark_offset_dn_std"], 3.0 * share)
    np.testing.assert_allclose(slope_std, 0.002 * share)
    np.testing.assert_allclose(found["offset_slope_covariance"], -3.0 * 0.002 * share**2)
