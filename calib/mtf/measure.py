"""From the images of a scan to the pixel's transfer function: all steps, in their order."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from calib.mtf.assembly.coarse_alignment import coarse_alignment
from calib.mtf.assembly.saturation import check_saturation
from calib.mtf.estimate import TransferFunction
from calib.mtf.estimation.compact_psf import CompactPsf, Harmonic, compact_psf
from calib.mtf.estimation.harmonic_fit import HarmonicFit
from calib.mtf.estimation.joint_fit import joint_fit
from calib.mtf.filter.filter_estimate import filter_estimate
from calib.mtf.geometry import Alignment, Scan
from calib.mtf.grating.grating import Grating
from calib.mtf.scan_images import ScanImages

Method = Literal["regularised", "filter"]
Vector = NDArray[np.floating]
_ALIGNED, _FITTED = 0.1, 0.45
"""The shares of the time after the first two steps, measured on 40 to 96 rows."""


@dataclass(frozen=True, eq=False)
class Measurement:
    """What a scan says of the pixel and of the bench.

    Attributes:
        scan: The nominal geometry.
        grating: What was projected.
        method: Of `transfer`.
        support: Pixels along a side of the support, or the window's FWHM.
        fit: Harmonics, geometry, pixels.
        psf: The regularised estimate.
        transfer: By the method that was asked for.
        shift_um: Where the pattern lies with the PSF's centroid at 0, (x, y), grating's frame, µm.
        shift_covariance: Of it, (2, 2), µm².
        without_pattern: Stage positions whose frame was left out: it does not show the pattern.
    """

    scan: Scan
    grating: Grating
    method: Method
    support: int
    fit: HarmonicFit
    psf: CompactPsf
    transfer: TransferFunction
    shift_um: Vector
    shift_covariance: NDArray[np.floating]
    without_pattern: tuple[int, ...]

    @cached_property
    def frequency_per_um(self) -> Vector:
        """An axis that holds 0, Nyquist's frequency and 1/pitch, up to the pattern's highest."""
        step = 1 / (16 * self.scan.pitch_um)
        n = int(np.ceil(self.grating.max_frequency_per_um / step))
        return step * np.arange(-n, n + 1)

    @property
    def position_um(self) -> Vector:
        """An axis for the PSF."""
        return self.psf.basis.position_um


def measure(
    scan: ScanImages,
    method: Method = "regularised",
    support: int = 3,
    progress: Callable[[float], None] = lambda _: None,
) -> Measurement:
    """Reduce a scan.

    Args:
        scan: The images.
        method: "regularised" (direct least squares, then a PSF on a compact support) or "filter"
            (the paper's).
        support: 3 or 5 pixels.
        progress: Called with the share that is done, 0 to 1, after each step.

    Raises:
        NotDeterminedError: Where the recording does not determine the result; its code says why.
    """
    check_saturation(scan.images)
    coarse = coarse_alignment(scan)
    progress(_ALIGNED)
    blind = tuple(scan.positions[k] for k in coarse.without_pattern)
    kept = scan.without(coarse.without_pattern) if blind else scan
    fit = joint_fit(kept, _kept(coarse.alignment, coarse.without_pattern))
    progress(_FITTED)
    highest = float(np.hypot(*fit.detector_per_um.T).max())
    measured = Harmonic(fit.detector_per_um, fit.transfer, fit.transfer_covariance)
    psf, centroid = compact_psf(measured, scan.scan.pitch_um, highest, support)
    turn = (1 + fit.scale[0]) * _turn(scan.scan.tilt_rad + fit.tilt_rad[0])
    shift = scan.grating.harmonics.shortest(fit.state.sampling.alignment.shift_um + turn @ centroid)
    covariance = turn @ psf.centroid_covariance @ turn.T
    found: TransferFunction = psf
    if method == "filter":
        found = filter_estimate(fit, shift, support)
    return Measurement(
        scan.scan, scan.grating, method, support, fit, psf, found, shift, covariance, blind
    )


def _kept(alignment: Alignment, left_out: tuple[int, ...]) -> Alignment:
    if alignment.stage_um is None or not left_out:
        return alignment
    return replace(alignment, stage_um=np.delete(alignment.stage_um, left_out, axis=0))


def _turn(tilt_rad: float) -> NDArray[np.floating]:
    """Return what turns lengths of the detector's frame into the grating's."""
    cos, sin = np.cos(tilt_rad), np.sin(tilt_rad)
    return np.array([[cos, -sin], [sin, cos]])
