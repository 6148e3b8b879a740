"""Which blocks are one scene at t and at 2t."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from calib.errors import NotDeterminedError
from calib.recording.header import Block
from calib.recording.protocol import Recording
from calib.transfer.two_exposures.pixel_maps import Method

DOUBLED_WITHIN = 0.05
"""Relative; a ratio farther from 2 is no doubling."""
SAME_EXPOSURE = 1e-3
"""Relative; exposures that were read back so near to one another are repeats."""
CLIPPED_AT_A_GLANCE = 0.01
"""A scene of which so much of the first frame clips is passed over for a darker one."""


@dataclass(frozen=True)
class Choice:
    """The blocks of the two exposures; repeats of the same exposure are merged.

    Attributes:
        first: At t.
        second: At r·t.
        scene: What both show, in words.
    """

    first: tuple[Block, ...]
    second: tuple[Block, ...]
    scene: str

    @property
    def ratio(self) -> float:
        """r, of the exposures as read back."""
        return _exposure(self.second) / _exposure(self.first)

    @property
    def monitor_ratio(self) -> float:
        """The light's power at the second exposure over that at the first; NaN where not seen."""
        seen = [[b.monitor for b in blocks] for blocks in (self.first, self.second)]
        one, two = ([m for m in each if m is not None] for each in seen)
        if len(one) + len(two) < len(self.first) + len(self.second) or not np.mean(one):
            return float("nan")
        return float(np.mean(two) / np.mean(one))


def choose(recording: Recording, method: Method) -> Choice:
    """Return the brightest scene at two exposures that does not clip at the first glance.

    SANUC takes exposures of which one is twice the other, within `DOUBLED_WITHIN`; S3NUC any two,
    and those nearest to a doubling where there are several.

    Raises:
        NotDeterminedError: `two-flats-missing`, `not-doubled` or `clipped`.
    """
    pairs = sorted(_pairs(recording.header.blocks), key=_brightness, reverse=True)
    if not pairs:
        raise NotDeterminedError(
            f"{recording.path} has no scene at two exposures: record flats of one level at t and "
            "at 2 t",
            code="two-flats-missing",
        )
    nearest = min(abs(pair.ratio - 2.0) for pair in pairs)
    allowed = 2.0 * DOUBLED_WITHIN if method == "sanuc" else nearest + SAME_EXPOSURE
    usable = [pair for pair in pairs if abs(pair.ratio - 2.0) <= allowed]
    if not usable:
        ratio = min((pair.ratio for pair in pairs), key=lambda r: abs(r - 2.0))
        raise NotDeterminedError(
            f"{recording.path}: no exposure is twice another one of the same scene (nearest ratio "
            f"{ratio:.4g}): record flats of one level at t and at 2 t, or use s3nuc",
            code="not-doubled",
        )
    for pair in usable:
        if _clipped_share(recording, pair.second[0]) < CLIPPED_AT_A_GLANCE:
            return pair
    raise NotDeterminedError(
        f"{recording.path}: the longer exposure clips in every scene: shorten it, or take light "
        "away",
        code="clipped",
    )


def _pairs(blocks: Sequence[Block]) -> Iterator[Choice]:
    """Yield each two exposures of each scene, the shorter first."""
    scenes: dict[tuple[str, float, str], list[Block]] = {}
    for block in blocks:
        if block.kind != "dark":
            scenes.setdefault((block.kind, block.level, block.scene or ""), []).append(block)
    for (kind, level, scene), shown in scenes.items():
        words = f"scene {scene}" if kind == "scene" else f"flats of level {level:g}"
        for one, two in combinations(_by_exposure(shown), 2):
            yield Choice(one, two, words)


def _by_exposure(blocks: Sequence[Block]) -> list[tuple[Block, ...]]:
    """Return repeats of one exposure together, in ascending order of the exposure."""
    groups: list[list[Block]] = []
    for block in sorted(blocks, key=lambda b: b.exposure_us):
        if groups and block.exposure_us <= groups[-1][0].exposure_us * (1 + SAME_EXPOSURE):
            groups[-1].append(block)
        else:
            groups.append([block])
    return [tuple(group) for group in groups]


def _exposure(blocks: Sequence[Block]) -> float:
    return float(np.mean([block.exposure_us for block in blocks]))


def _brightness(pair: Choice) -> float:
    return pair.second[0].level * _exposure(pair.second)


def _clipped_share(recording: Recording, block: Block) -> float:
    """Return the share of the block's first frame that stands at the highest code."""
    first = next(iter(recording.frames(block.block)))[0]
    return float(np.mean(first >= recording.header.camera.full_scale_dn))
