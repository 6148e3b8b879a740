"""What a plan leaves unknown, and which blocks would tell it: one sentence each."""

from calib.recording.header import RecordingHeader

FEW_FRAMES = 8
"""Of an area sensor: of fewer, tones from frame to frame and fourth moments are not looked for."""


def limits(header: RecordingHeader) -> tuple[str, ...]:
    """Return them; nothing where the plan has several exposures, darks, and lines enough."""
    return tuple(text for text in (_one_signal(header), _few_frames(header)) if text)


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
