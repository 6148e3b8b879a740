"""What a calibration has seen."""

from collections.abc import Sequence

import numpy as np

from calib.radiometric.coefficients.provenance import Domain
from calib.radiometric.estimation.block_table import BlockTable
from calib.radiometric.estimation.joint_fit import JointFit
from calib.recording.header import Block


def domain_of(
    flats: BlockTable,
    darks: BlockTable,
    fit: JointFit,
    radiance_of_reference: float,
    blocks: Sequence[Block],
) -> Domain:
    """Return the ranges that the cells in the fit, and the darks beside them, cover.

    Darks verify the intercept: between them and the dimmest flat nothing is extrapolated.

    Args:
        flats: The flats.
        darks: The capped darks; may have no blocks.
        fit: Their fit; a weight of 0 was left out.
        radiance_of_reference: Radiance where the relative level is 1.
        blocks: All blocks, for the temperature.
    """
    used = fit.weights > 0
    rows = used.any(axis=1)
    exposure = flats.exposure_us[rows]
    radiance = fit.x_us[rows] / exposure * radiance_of_reference
    dn = flats.mean_dn[used]
    if len(darks):
        dn = np.concatenate([dn, darks.mean_dn[:, used.any(axis=0)].ravel()])
        radiance = np.append(radiance, 0.0)
    seen = [b.sensor_temperature_c for b in blocks if b.sensor_temperature_c is not None]
    return Domain(
        exposure_us=(float(exposure.min()), float(exposure.max())),
        dn=(float(dn.min()), float(dn.max())),
        radiance=(float(radiance.min()), float(radiance.max())),
        temperature_c=(min(seen), max(seen)) if seen else None,
    )
