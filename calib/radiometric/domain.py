"""What a calibration has seen."""

from collections.abc import Sequence

import numpy as np

from calib.radiometric.block_table import BlockTable
from calib.radiometric.joint_fit import JointFit
from calib.radiometric.provenance import Domain
from calib.recording.header import Block


def domain_of(
    flats: BlockTable, fit: JointFit, radiance_of_reference: float, blocks: Sequence[Block]
) -> Domain:
    """Return the ranges that the cells in the fit cover.

    Args:
        flats: The flats.
        fit: Their fit; a weight of 0 was left out.
        radiance_of_reference: Radiance where the relative level is 1.
        blocks: All blocks, for the temperature.
    """
    used = fit.weights > 0
    rows = used.any(axis=1)
    exposure = flats.exposure_us[rows]
    radiance = fit.x_us[rows] / exposure * radiance_of_reference
    seen = [b.sensor_temperature_c for b in blocks if b.sensor_temperature_c is not None]
    return Domain(
        exposure_us=(float(exposure.min()), float(exposure.max())),
        dn=(float(np.min(flats.mean_dn[used])), float(np.max(flats.mean_dn[used]))),
        radiance=(float(radiance.min()), float(radiance.max())),
        temperature_c=(min(seen), max(seen)) if seen else None,
    )
