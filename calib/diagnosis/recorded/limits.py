"""What a plan leaves unknown, and which blocks would tell it: one sentence each."""

import numpy as np
from numpy.typing import NDArray

from calib.forward.departure import Departure
from calib.recording.header import RecordingHeader

TELLING = 4
"""Lines, or frames, of which a sample is told from its pixel's mean."""
_OF_SINGLE_SAMPLES = ("transient", "histogram", "tail", "line_covariance")
FEW_FRAMES = 8
"""Of an area sensor: of fewer, tones from frame to frame and fourth moments are not looked for."""


def limits(header: RecordingHeader) -> tuple[str, ...]:
    """Return them; nothing where the plan has several exposures, darks, and lines enough."""
    return tuple(text for text in (_one_signal(header), _few_frames(header)) if text)


def too_few_frames(kind: type[Departure], n_lines: NDArray[np.float64]) -> str | None:
    """Return why blocks of so many lines cannot show an effect; None where they may.

    Of two or three frames a pixel's mean follows its noise, and a residual its neighbour in time.
    """
    if n_lines.max() >= TELLING or kind.shows_in not in _OF_SINGLE_SAMPLES:
        return None
    return f"needs blocks of {TELLING} frames or more: of fewer, single samples tell nothing"


def _one_signal(header: RecordingHeader) -> str:
    flats = [block for block in header.blocks if block.kind == "flat"]
    doses = sorted({(b.radiance or b.level) * b.exposure_us for b in flats})
    if len(doses) != 1:
        return ""
    longest = max(b.exposure_us for b in flats)
    wanted = ", ".join(f"{longest * share:.0f}" for share in (0.125, 0.25, 0.5, 1.5))
    return (
        "All flats have one signal: whether the response bends, whether the exposure is longer "
        "than told, and whether covariances grow with the signal (interpixel_capacitance) or with "
        "its square (brighter_fatter) cannot be known; add flats of "
        f"{wanted} us, and darks at two exposures."
    )


def _few_frames(header: RecordingHeader) -> str:
    known = [block.lines for block in header.blocks if block.lines is not None]
    if header.camera.rows is None or not known or max(known) >= FEW_FRAMES:
        return ""
    return (
        f"No block has more than {max(known)} frames: what changes from frame to frame, and noise "
        f"of single pixels, is hardly seen; record {FEW_FRAMES} frames or more of each."
    )
