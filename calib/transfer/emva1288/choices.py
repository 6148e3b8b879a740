"""Which flat the nonuniformities are from."""

import numpy as np

from calib.errors import NotDeterminedError
from calib.transfer.emva1288.saturation import SaturationPoint
from calib.transfer.emva1288.series import Series

HALF = (0.4, 0.6)


def saturation_shares(series: Series, point: SaturationPoint) -> np.ndarray:
    """Return each flat's signal as a share of saturation's, (n_flats,)."""
    dark = np.array([series.darks[k].mean_dn for k in series.dark_of])
    means = np.array([f.mean_dn for f in series.flats])
    return np.asarray((means - dark) / point.reference_dn)


def spatial_blocks(series: Series, point: SaturationPoint) -> int:
    """Return the index of the flat nearest to 50 % of saturation.

    Among those between 40 and 60 %, the one with the most frames: the standard averages many.
    """
    shares = saturation_shares(series, point)
    inside = np.flatnonzero((shares >= HALF[0]) & (shares <= HALF[1]))
    off = np.abs(shares - 0.5)
    if len(inside):
        frames = np.array([series.flats[k].n_frames for k in inside])
        best = inside[frames == frames.max()]
        return int(best[np.argmin(off[best])])
    unclipped = np.array([not f.share_at_full_scale > 0.002 for f in series.flats])
    if not np.any(unclipped & (shares > 0)):
        raise NotDeterminedError(
            "no flat is brighter than its dark: light the camera", code="no-light"
        )
    return int(np.argmin(np.where(unclipped & (shares > 0), off, np.inf)))
