"""What was measured, as one vector of independent numbers with their standard uncertainties."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.transfer.emva1288.nonuniformity import SpatialInputs
from calib.transfer.emva1288.propagation import Batch
from calib.transfer.emva1288.saturation import SaturationPoint
from calib.transfer.emva1288.series import Series


@dataclass(frozen=True)
class Measured:
    """One or many variants of what was measured; a leading axis where many."""

    flat_mean: Batch
    flat_variance: Batch
    dark_mean: Batch
    dark_variance: Batch
    saturation: Batch
    gain_misfit: Batch
    response_misfit: Batch
    spatial: tuple[Batch, ...]


def vector_of(
    series: Series,
    point: SaturationPoint,
    misfits: tuple[float, float],
    spatial: SpatialInputs | None,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return values and standard uncertainties, in the order in which `unpacked` takes them."""
    flats, darks = series.flats, series.darks
    values = [
        [f.mean_dn for f in flats],
        [f.variance_dn2 for f in flats],
        [d.mean_dn for d in darks],
        [d.variance_dn2 for d in darks],
        [np.nan_to_num(point.mean_dn), 0.0, 0.0],
    ]
    stds = [
        [f.mean_dn_std for f in flats],
        [f.variance_dn2_std for f in flats],
        [d.mean_dn_std for d in darks],
        [d.variance_dn2_std for d in darks],
        [np.nan_to_num(point.mean_std), *misfits],
    ]
    for part in () if spatial is None else spatial.parts:
        values.append(list(part.values))
        stds.append(list(part.std))
    return np.concatenate(values), np.concatenate(stds)


def unpacked(batch: Batch, series: Series, spatial: SpatialInputs | None) -> Measured:
    """Give the vectors' parts their names."""
    n, m = len(series.flats), len(series.darks)
    sizes = [n, n, m, m, 1, 1, 1]
    sizes += [] if spatial is None else [len(part.values) for part in spatial.parts]
    parts = np.split(batch, np.cumsum(sizes)[:-1], axis=-1)
    saturation, gain, response = (part[..., 0] for part in parts[4:7])
    flat_mean, flat_variance, dark_mean, dark_variance = parts[:4]
    return Measured(
        flat_mean=flat_mean,
        flat_variance=flat_variance,
        dark_mean=dark_mean,
        dark_variance=dark_variance,
        saturation=saturation,
        gain_misfit=gain,
        response_misfit=response,
        spatial=tuple(parts[7:]),
    )
