"""Is the response a line over the range: other exposures of the scene, and capped darks."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import islice

import numpy as np

from calib.kernels.pixel_sums import Pixels
from calib.recording.header import Block
from calib.recording.protocol import Recording
from calib.transfer.two_exposures.choice import Choice
from calib.transfer.two_exposures.finding import Finding

FRAMES = 32
"""So many frames (lines) of each block are looked at."""
SEEN_SIGMA = 5.0
BENT = 0.005
"""Of the signal: a distance from the line that is worth a warning."""
_CLIPPED = 1e-3


@dataclass(frozen=True)
class MeanLevel:
    """A block's mean over pixels and frames, DN, and its standard error from frame to frame."""

    block: Block
    mean_dn: float
    std_dn: float


def linearity_findings(
    recording: Recording, choice: Choice, cancelled: Callable[[], bool]
) -> Iterator[Finding]:
    """Yield whether exposures beside the two, and darks, lie on the line through the two."""
    chosen = {b.block for b in (*choice.first, *choice.second)}
    others = [b for b in recording.header.blocks if b.block not in chosen]
    same = [b for b in others if _same_scene(b, choice.first[0])]
    darks = [b for b in others if b.kind == "dark"]
    if not same and not darks:
        return
    one, two = (_levels(recording, blocks, cancelled) for blocks in (choice.first, choice.second))
    if not one or not two:
        return
    lever = _Lever(one, two)
    for level in _levels(recording, same, cancelled):
        yield from lever.bend(level, level.block.exposure_us, "The response is not linear")
    for level in _levels(recording, darks, cancelled):
        yield from lever.bend(level, 0.0, "Capped darks do not read the bias")


class _Lever:
    """The line through the two exposures' mean levels."""

    def __init__(self, one: list[MeanLevel], two: list[MeanLevel]) -> None:
        self._t1, self._m1, self._s1 = _average(one)
        self._t2, self._m2, self._s2 = _average(two)

    def bend(self, level: MeanLevel, exposure_us: float, what: str) -> Iterator[Finding]:
        """Yield how far off the line the level lies, if it does."""
        at = (exposure_us - self._t1) / (self._t2 - self._t1)
        off = level.mean_dn - self._m1 - at * (self._m2 - self._m1)
        std = float(np.hypot(level.std_dn, np.hypot((1 - at) * self._s1, at * self._s2)))
        signal = (self._m2 - self._m1) / (self._t2 - self._t1) * self._t2
        share = abs(off) / signal if signal > 0 else np.inf
        if abs(off) > SEEN_SIGMA * std and share > BENT:
            yield Finding(
                "not-linear",
                f"{what}: block {level.block.block} lies {off:+.3g} DN off the line through the "
                f"two exposures ({100 * share:.2g} % of the signal, {abs(off) / std:.0f} sigma): "
                "nonlinearity, an exposure that is not what it says, stray light, or a lamp that "
                "changed; bias and read noise are off by as much.",
                float(off),
            )


def _same_scene(block: Block, other: Block) -> bool:
    return (block.kind, block.level, block.scene) == (other.kind, other.level, other.scene)


def _levels(
    recording: Recording, blocks: list[Block] | tuple[Block, ...], cancelled: Callable[[], bool]
) -> list[MeanLevel]:
    """Return the mean levels of the blocks that do not clip."""
    levels = []
    for block in blocks:
        means = np.empty(0) if cancelled() else _frame_means(recording, block)
        if len(means) > 1:
            std = float(means.std(ddof=1) / np.sqrt(len(means)))
            levels.append(MeanLevel(block, float(means.mean()), std))
    return levels


def _frame_means(recording: Recording, block: Block) -> Pixels:
    """Return the first frames' means, DN; none where more than a few samples clip."""
    means: list[float] = []
    full_scale = recording.header.camera.full_scale_dn
    for stretch in recording.frames(block.block):
        for frame in islice(stretch, FRAMES - len(means)):
            if np.mean(frame >= full_scale) > _CLIPPED:
                return np.empty(0)
            means.append(float(np.mean(frame, dtype=np.float64)))
        if len(means) == FRAMES:
            break
    return np.array(means)


def _average(levels: list[MeanLevel]) -> tuple[float, float, float]:
    """Return exposure, mean and its standard error over repeats."""
    exposure = float(np.mean([level.block.exposure_us for level in levels]))
    mean = float(np.mean([level.mean_dn for level in levels]))
    return exposure, mean, float(np.hypot.reduce([s.std_dn for s in levels])) / len(levels)
