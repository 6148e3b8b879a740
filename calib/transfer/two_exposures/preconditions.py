"""What the two exposures take for granted, tested from the recording itself.

The second exposure is twice the first, the scene stands still, the response is linear, nothing
clips, and there are frames enough for what is asked of a single pixel. What does not hold becomes a
warning with its figure, or a refusal.
"""

from collections.abc import Callable, Iterator

import numpy as np

from calib.recording.protocol import Recording
from calib.transfer.two_exposures.choice import DOUBLED_WITHIN, Choice
from calib.transfer.two_exposures.exposure_pair import ExposurePair
from calib.transfer.two_exposures.finding import Finding
from calib.transfer.two_exposures.linearity import linearity_findings
from calib.transfer.two_exposures.pixel_maps import Method
from calib.transfer.two_exposures.static_scene import drift_findings, pattern_findings
from calib.transfer.two_exposures.stream import ReadExposure

RATIO_NOTED = 1e-3
MONITOR_NOTED = 2e-3
CLIPPED_NOTED, CLIPPED_REFUSED = 1e-3, 0.5
USABLE_RELATIVE_STD = 1.0 / 3.0
"""A pixel's photo-electrons have a usable error up to here: their denominator is then 3 sigma."""


def findings(
    recording: Recording,
    choice: Choice,
    method: Method,
    read: tuple[ReadExposure, ReadExposure],
    pair: ExposurePair,
    *,
    cancelled: Callable[[], bool],
) -> Iterator[Finding]:
    """Yield everything that does not hold."""
    yield from doubling_findings(choice, method)
    yield from clipping_findings(pair)
    seen = pair.unclipped_sums
    if not seen.n_pixels:
        return
    shot = (seen.variances_dn2[1] - seen.variances_dn2[0]) / seen.n_pixels
    signal = (seen.means_dn[1] - seen.means_dn[0]) / seen.n_pixels / (pair.ratio - 1.0)
    n_pixels = pair.n_pixels
    for exposure, lit in zip(read, (signal, pair.ratio * signal), strict=True):
        for series in exposure.series:
            means = series.frame_sums.sum(axis=1) / n_pixels
            yield from drift_findings(series.block, means, lit, shot)
        yield from pattern_findings(exposure.changes, shot)
    yield from linearity_findings(recording, choice, cancelled)
    if method == "sanuc":
        yield from frames_findings(pair)


def doubling_findings(choice: Choice, method: Method) -> Iterator[Finding]:
    """Yield whether the light of the second exposure is twice that of the first."""
    if method == "s3nuc":
        return
    ratio, power = choice.ratio, choice.monitor_ratio
    if abs(ratio - 2.0) > 2.0 * RATIO_NOTED:
        yield Finding(
            "not-doubled",
            f"The second exposure is {ratio:.5g} times the first, as read back, not twice; the "
            "equations take that ratio.",
            ratio,
        )
    if np.isfinite(power) and abs(power - 1.0) > MONITOR_NOTED:
        far = abs(ratio * power - 2.0) > 2.0 * DOUBLED_WITHIN
        yield Finding(
            "not-doubled",
            f"By the monitor the light changed by {100 * (power - 1):+.2g} % from the first "
            f"exposure to the second ({choice.scene}): bias is off by {100 * (1 - power):+.2g} % "
            "of the signal; let the lamp settle, or record both anew.",
            float(ratio * power),
            "refusal" if far else "warning",
        )


def clipping_findings(pair: ExposurePair) -> Iterator[Finding]:
    """Yield which share of the pixels clips, at either end, at either exposure."""
    seen = pair.unclipped_sums
    for where, n in (("full scale", seen.n_at_full_scale), ("code 0", seen.n_at_zero)):
        share = n / pair.n_pixels
        if share > CLIPPED_NOTED:
            yield Finding(
                "clipped",
                f"{100 * share:.2g} % of the pixels clip at {where} in some frame and are left "
                "out; of their neighbours those are kept that by chance did not: change light, "
                "exposure or black level.",
                share,
                "refusal" if share > CLIPPED_REFUSED else "warning",
            )


def frames_findings(pair: ExposurePair) -> Iterator[Finding]:
    """Yield whether a pixel's photo-electrons have a usable error at so few frames."""
    needed = frames_needed(pair)
    if min(pair.first.n_frames, pair.second.n_frames) < needed:
        yield Finding(
            "few-frames",
            f"{pair.first.n_frames} and {pair.second.n_frames} frames: a single pixel's "
            f"photo-electrons have a usable error from about {needed} frames on; use the pooled "
            "ones.",
            float(needed),
        )


def frames_needed(pair: ExposurePair) -> int:
    """Return from how many frames on a typical pixel's photo-electrons have a usable error.

    n = 1 + 2(σ₁⁴ + σ₂⁴)/(V·u)² with u = 1/3, from means over the pixels; 91 in the limit of shot
    noise. 0 where no shot noise is seen.
    """
    seen = pair.unclipped_sums
    one, two = (each / max(seen.n_pixels, 1) for each in seen.variances_dn2)
    if not two > one:
        return 0
    return 1 + int(np.ceil(2.0 * (one**2 + two**2) / ((two - one) * USABLE_RELATIVE_STD) ** 2))
