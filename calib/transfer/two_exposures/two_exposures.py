"""SANUC or S3NUC of a recording: maps, pooled estimates, and what speaks against them."""

from collections.abc import Callable
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from calib.kernels.pooled_sums import ALL_TAPS, MEMBERS, WEIGHT
from calib.recording.header import CameraHeader
from calib.recording.protocol import Recording
from calib.recording.statistics import Progress, never
from calib.transfer.estimate import Estimate
from calib.transfer.two_exposures.choice import Choice, choose
from calib.transfer.two_exposures.exposure_pair import ExposurePair
from calib.transfer.two_exposures.finding import Finding, checked
from calib.transfer.two_exposures.frame_series import FrameSeries
from calib.transfer.two_exposures.pixel_maps import Method, PixelMaps
from calib.transfer.two_exposures.pooled import FEWEST_PIXELS, PooledEstimates, pooled
from calib.transfer.two_exposures.preconditions import findings
from calib.transfer.two_exposures.s3nuc import s3nuc
from calib.transfer.two_exposures.sanuc import sanuc
from calib.transfer.two_exposures.stream import ReadExposure, read_exposure
from calib.transfer.two_exposures.tap_map import image_shape, tap_of_pixel
from calib.transfer.two_exposures.tap_sums import TapSums
from calib.transfer.two_exposures.weights import weights


@dataclass(frozen=True)
class TwoExposures:
    """What two exposures of one scene tell.

    Attributes:
        method: "sanuc" or "s3nuc".
        camera: The camera, as set in the recording.
        choice: The blocks.
        pair: Moments of every pixel.
        maps: Per pixel.
        pooled: Of all pixels that do not clip.
        per_tap: The same tap by tap; None for a tap of too few pixels. Empty where there is one.
        findings: What speaks against them.
        warnings: Their sentences, and the recording's own.
    """

    method: Method
    camera: CameraHeader
    choice: Choice
    pair: ExposurePair
    maps: PixelMaps
    pooled: PooledEstimates
    per_tap: tuple[PooledEstimates | None, ...]
    findings: tuple[Finding, ...]
    warnings: tuple[str, ...]

    @property
    def shape(self) -> tuple[int, ...]:
        """(n_rows, n_columns), or (n_columns,) of a line sensor."""
        return image_shape(self.camera)

    def answer(self) -> dict[str, Any]:
        """Return what `darkflat photon-transfer --method sanuc|s3nuc --json` prints."""
        estimates = {f.name: getattr(self.pooled, f.name) for f in fields(self.pooled)}
        return {
            "method": self.method,
            "blocks": {
                "first": [b.block for b in self.choice.first],
                "second": [b.block for b in self.choice.second],
            },
            "exposure_ratio": self.pair.ratio,
            "frames": [self.pair.first.n_frames, self.pair.second.n_frames],
            **{n: e.answer() for n, e in estimates.items() if isinstance(e, Estimate)},
            "dispersion": list(self.pooled.dispersion),
            "pixels": self.pair.n_pixels,
            "pixels_pooled": self.pooled.n_pixels,
            "pixel_states": self.maps.counts(),
            "taps": [tap.answer() if tap else None for tap in self.per_tap],
            "findings": [finding.answer() for finding in self.findings],
            "warnings": list(self.warnings),
        }

    def save(self, path: Path | str) -> str:
        """Write MAPS.h5, whole or not at all; return the hash of its content.

        Raises:
            InputError: `cannot-write`; DiskFullError where there is no room.
        """
        about = {**self.answer(), "camera": self.camera.model_dump(mode="json", exclude_none=True)}
        return self.maps.save(path, self.shape, about)


def two_exposure_moments(
    recording: Recording,
    method: Method = "sanuc",
    *,
    progress: Progress | None = None,
    cancelled: Callable[[], bool] = never,
) -> TwoExposures:
    """Return maps and pooled estimates from two exposures of one scene.

    Each block is read once. Repeats of an exposure are merged.

    Args:
        recording: Flats of one level, or one scene, at t and at 2t (S3NUC: at any two exposures).
        method: Which equations.
        progress: Called with the share that is done, 0 to 1.
        cancelled: Asked before each stretch of frames; True ends in CancelledError.

    Raises:
        NotDeterminedError: `two-flats-missing`, `not-doubled`, `clipped`, `scene-moved`,
            `few-frames` or `too-few-pixels`.
    """
    choice = choose(recording, method)
    camera = recording.header.camera
    taps = tap_of_pixel(camera)

    def told(exposure: int) -> Callable[[float], None]:
        return lambda share: progress((exposure + share) / 2.0) if progress else None

    first, second = (
        read_exposure(recording, blocks, taps, told(k), cancelled)
        for k, blocks in enumerate((choice.first, choice.second))
    )
    pair = ExposurePair(first.moments, second.moments, choice.ratio)
    found = checked(findings(recording, choice, method, (first, second), pair, cancelled=cancelled))
    every, per_tap = _pooled(pair, (first, second), taps, image_shape(camera), method)
    return TwoExposures(
        method=method,
        camera=camera,
        choice=choice,
        pair=pair,
        maps=(sanuc if method == "sanuc" else s3nuc)(pair),
        pooled=every,
        per_tap=per_tap,
        findings=found,
        warnings=(*recording.warnings, *(finding.text for finding in found)),
    )


def _pooled(
    pair: ExposurePair,
    read: tuple[ReadExposure, ReadExposure],
    tap: NDArray[np.uint8],
    shape: tuple[int, ...],
    method: Method,
) -> tuple[PooledEstimates, tuple[PooledEstimates | None, ...]]:
    """Return the estimates of all pixels, and of each tap where there are several."""
    alive = (pair.first.variance_dn2 > 0) | (pair.second.variance_dn2 > 0)
    usable = pair.unclipped & alive
    sums = TapSums.of(pair, weights(pair, usable, shape), tap)
    n_taps, tap_pixels = len(sums.by_tap), sums.by_tap[:, MEMBERS, WEIGHT].astype(np.int64)

    def over(of_tap: int) -> PooledEstimates:
        taps = list(range(n_taps)) if of_tap == ALL_TAPS else [of_tap]
        series = [FrameSeries.of(each.series, tap_pixels, taps) for each in read]
        return pooled(sums, of_tap, series, method)

    every = over(ALL_TAPS)
    if n_taps == 1:
        return every, ()
    enough = (sums.n_usable(t) >= FEWEST_PIXELS for t in range(n_taps))
    return every, tuple(over(t) if ok else None for t, ok in enumerate(enough))
