"""Was the scene static: do frame means drift, does the picture change between early and late."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from calib.kernels.pixel_moments import FRAMES_AT_ONCE
from calib.kernels.pixel_sums import Pixels, Sums
from calib.transfer.two_exposures.exposure_pair import ExposureMoments
from calib.transfer.two_exposures.finding import Finding

SEEN_SIGMA = 5.0
WARNED_SHARE, REFUSED_SHARE = 0.01, 0.10
"""Of V, the shot noise's growth that the gain is made of, by which a motion raises variances."""
WARNED_DRIFT, REFUSED_DRIFT = 0.002, 0.05
"""Of the signal, by which frame means drift within a block."""
_MOST_PIXELS = 1 << 18


@dataclass(frozen=True)
class PatternChange:
    """The mean of a block's first eight frames against that of all others, pixel by pixel.

    What all pixels do alike, an offset and a factor, is fitted and left out.

    Attributes:
        block: The block's name.
        mean_square_dn2: Of the change, without its noise; NaN below sixteen frames.
        std_dn2: Its standard error.
    """

    block: str
    mean_square_dn2: float
    std_dn2: float


def looked_at(n_pixels: int) -> slice:
    """Return the pixels whose change is looked at: all, or every so many of a large sensor."""
    return slice(None, None, -(-n_pixels // _MOST_PIXELS))


def pattern_change(
    block: str, codes: Sums, early_codes: Sums, moments: ExposureMoments
) -> PatternChange:
    """Compare early with late.

    Args:
        block: Its name.
        codes: Sums of codes of the pixels `looked_at` over all frames.
        early_codes: The same over the first eight.
        moments: Of all pixels.
    """
    n, k = moments.n_frames, FRAMES_AT_ONCE
    if n < 2 * k:
        return PatternChange(block, float("nan"), float("nan"))
    some = looked_at(moments.mean_dn.size)
    usable = (moments.at_zero[some] == 0) & (moments.at_full_scale[some] == 0)
    early = early_codes[usable] / k
    late = (codes[usable] - early_codes[usable]) / (n - k)
    variance = moments.variance_dn2[some][usable] * (1.0 / k + 1.0 / (n - k))
    if early.size < k:
        return PatternChange(block, float("nan"), float("nan"))
    squares = np.square(_without_line(early - late, late))
    excess = float(np.sum(squares) - np.sum(variance) * (1.0 - 2.0 / early.size))
    std = float(np.sqrt(2.0 * np.sum(variance**2)))
    return PatternChange(block, excess / early.size, std / early.size)


def _without_line(change: Pixels, signal: Pixels) -> Pixels:
    """Return the change without its straight line over the signal."""
    about = signal - signal.mean()
    power = float(about @ about)
    slope = float(about @ change) / power if power > 0 else 0.0
    return np.asarray(change - change.mean() - slope * about)


def pattern_findings(changes: Sequence[PatternChange], shot_dn2: float) -> Iterator[Finding]:
    """Yield what changes of the picture say; `shot_dn2` is V, mean over the pixels, DN²."""
    for change in changes:
        share = change.mean_square_dn2 / shot_dn2 if shot_dn2 > 0 else np.inf
        sigma = change.mean_square_dn2 / change.std_dn2 if change.std_dn2 > 0 else 0.0
        if not (sigma > SEEN_SIGMA and share > WARNED_SHARE):
            continue
        rms = float(np.sqrt(change.mean_square_dn2))
        yield Finding(
            "scene-moved",
            f"The picture of block {change.block} changed by {rms:.3g} DN rms between its first "
            f"{FRAMES_AT_ONCE} frames and the others ({sigma:.0f} sigma, {100 * share:.2g} % of "
            "the variance's growth): nothing may move, let camera and source settle.",
            rms,
            "refusal" if share > REFUSED_SHARE else "warning",
        )


def drift_findings(
    block: str, frame_means: Pixels, signal_dn: float, shot_dn2: float
) -> Iterator[Finding]:
    """Yield whether frame means drift along a block, (n_frames,), with its significance."""
    n = len(frame_means)
    if n < FRAMES_AT_ONCE:
        return
    time = np.arange(n) - (n - 1) / 2.0
    slope = float(time @ frame_means / (time @ time))
    rest = frame_means - frame_means.mean() - slope * time
    std = float(np.sqrt(rest @ rest / (n - 2) / (time @ time)))
    drift = slope * n
    sigma = abs(slope) / std if std > 0 else (np.inf if slope else 0.0)
    relative = abs(drift) / signal_dn if signal_dn > 0 else np.inf
    share = drift**2 / 12.0 / shot_dn2 if shot_dn2 > 0 else np.inf
    if sigma > SEEN_SIGMA and (relative > WARNED_DRIFT or share > WARNED_SHARE):
        yield Finding(
            "scene-moved",
            f"The frame means of block {block} drift by {drift:+.3g} DN ({sigma:.0f} sigma, "
            f"{100 * relative:.2g} % of the signal; it raises every pixel's variance by "
            f"{100 * share:.2g} % of its growth): let source and camera settle.",
            drift,
            "refusal" if relative > REFUSED_DRIFT or share > REFUSED_SHARE else "warning",
        )
