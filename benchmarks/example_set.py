"""A coefficient set of any width, such as a 12-bit camera might have."""

import numpy as np

from calib.budget import Budget, BudgetRow
from calib.radiometric.coefficients.coefficient_set import CoefficientSet
from calib.radiometric.coefficients.provenance import Domain, Provenance
from calib.recording.header import CameraHeader


def example_set(n_columns: int) -> CoefficientSet:
    """Return a set whose columns are all valid."""
    x = np.linspace(-1.0, 1.0, n_columns)
    vignette, ones = 1.0 - 0.5 * x**2, np.ones(n_columns)
    responsivity = 0.2 * ones
    certificate = BudgetRow("certificate", "B", "normal", 0.01, "1", 1.0, "common", "certificate")
    return CoefficientSet(
        camera=CameraHeader(serial="B0001", columns=n_columns, bit_depth=12, band="NIR"),
        radiance_unit="W m-2 sr-1",
        dark_offset_dn=30.0 * ones,
        dark_offset_dn_std=0.1 * ones,
        vignette=vignette,
        vignette_std=0.001 * np.abs(x),
        responsivity=responsivity,
        responsivity_std=0.01 * responsivity,
        slope=vignette * responsivity,
        slope_std=0.001 * vignette * responsivity,
        offset_slope_covariance=-1e-6 * ones,
        dark_current_dn_per_us=0 * ones,
        dark_current_dn_per_us_std=0 * ones,
        reason=np.zeros(n_columns, np.uint8),
        scale_relative_std=0.01,
        system_gain_dn_per_e=0.1,
        system_gain_dn_per_e_std=0.001,
        read_noise_e=20.0,
        read_noise_e_std=0.1,
        axis_column=(n_columns - 1) / 2,
        axis_column_std=0.5,
        vignette_order=2,
        reduced_chi_squared=1.0,
        domain=Domain((100.0, 500.0), (50.0, 3900.0), (10.0, 60.0), (24.0, 26.0)),
        budget=Budget("responsivity", "1", (certificate,)),
        provenance=Provenance("0" * 64, recording_name="benchmark"),
    )
