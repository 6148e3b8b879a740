"""A small coefficient set for tests that need one."""

from typing import Any

import numpy as np

from calib.budget import Budget, BudgetRow
from calib.radiometric.coefficients.coefficient_set import CoefficientSet
from calib.radiometric.coefficients.column_state import ColumnState
from calib.radiometric.coefficients.provenance import Domain, Provenance
from calib.recording.header import CameraHeader


def example_set(n: int = 32, **changes: Any) -> CoefficientSet:
    """Return a 12-bit set of `n` columns; column 3 is dead."""
    x = np.linspace(-1.0, 1.0, n)
    vignette = 1.0 - 0.5 * x**2
    responsivity = np.full(n, 0.2)
    reason = np.zeros(n, np.uint8)
    reason[3] = ColumnState.DEAD
    responsivity[3] = np.nan
    fields: dict[str, Any] = {
        "camera": CameraHeader(serial="B0001", columns=n, bit_depth=12, band="NIR"),
        "radiance_unit": "W m-2 sr-1",
        "dark_offset_dn": np.full(n, 30.0),
        "dark_offset_dn_std": np.full(n, 0.1),
        "vignette": vignette,
        "vignette_std": 0.001 * np.abs(x),
        "responsivity": responsivity,
        "responsivity_std": 0.01 * responsivity,
        "slope": vignette * responsivity,
        "slope_std": 0.001 * vignette * responsivity,
        "offset_slope_covariance": np.full(n, -1e-6),
        "dark_current_dn_per_us": np.zeros(n),
        "dark_current_dn_per_us_std": np.zeros(n),
        "reason": reason,
        "scale_relative_std": 0.0099,
        "system_gain_dn_per_e": 0.1,
        "system_gain_dn_per_e_std": 0.001,
        "read_noise_e": 20.0,
        "read_noise_e_std": 0.1,
        "axis_column": (n - 1) / 2,
        "axis_column_std": 0.5,
        "vignette_order": 2,
        "reduced_chi_squared": 1.0,
        "domain": Domain((100.0, 500.0), (50.0, 3900.0), (10.0, 60.0), (24.0, 26.0)),
        "budget": Budget(
            "responsivity",
            "1",
            (BudgetRow("certificate", "B", "normal", 0.0099, "1", 1.0, "common", "certificate"),),
        ),
        "provenance": Provenance("0" * 64, recording_name="rec.h5", parameters={"orders": "2-12"}),
    }
    return CoefficientSet(**{**fields, **changes})
