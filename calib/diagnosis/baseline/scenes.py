"""Scenes of unknown radiance: an image that stays in place while it is exposed for several times.

Nobody knows the radiance of a target to the precision that matters, nor how sharp the optics show
an edge of it. But whatever it is, it is the same at two exposures: each pixel's signal grows in
proportion to the exposure, from the offset that darks and flats know. What does not is charge that
moves: charge-transfer inefficiency defers a larger share of small charges than of large ones, and
so trails an edge the more, relative to it, the weaker it is exposed. Interpixel capacitance and
optics spread the same share at each exposure, and leave nothing.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from calib.arrays import Columns
from calib.diagnosis.baseline.baseline import Baseline, fit_baseline
from calib.diagnosis.recorded.conditions_table import ConditionsTable, conditions_table
from calib.diagnosis.recorded.joint import Joint
from calib.diagnosis.recorded.scene_light import has_known_light
from calib.diagnosis.recorded.sensor import Sensor
from calib.diagnosis.statistics.block_sums import BlockSums
from calib.recording.header import Block

STEADY = 1.5
"""Where the lines' variance exceeds the expected one by this factor, the scene moved."""


@dataclass(frozen=True)
class SteadyLight:
    """Blocks whose light is known, or stays the same at several exposures."""

    sums: tuple[BlockSums, ...]
    table: ConditionsTable


def with_steady_light(
    whole: Joint, sums: Sequence[BlockSums], images: Mapping[str, Columns]
) -> SteadyLight:
    """Return the blocks without scenes of which nothing is known.

    Args:
        whole: The recordings.
        sums: Of all blocks.
        images: Radiance along the columns of scenes where it is known, by name.
    """
    blocks = whole.header.blocks
    uniform = [b for b, block in enumerate(blocks) if has_known_light(block, whole.header, images)]
    known = _light(whole, sums, uniform, images)
    found: dict[str, Columns] = {}
    if len(uniform) < len(blocks) and whole.header.camera.rows is None:
        base = fit_baseline(known.sums, known.table, Sensor(whole.header.camera))
        names = {b.scene for b in blocks if b.kind == "scene" and b.scene and b.scene not in images}
        for name in sorted(names):
            at = [b for b, block in enumerate(blocks) if block.scene == name]
            radiance = _radiance([sums[b] for b in at], [blocks[b] for b in at], base)
            found |= {} if radiance is None else {name: radiance}
    if not found:
        return known
    kept = [b for b, block in enumerate(blocks) if b in uniform or block.scene in found]
    return _light(whole, sums, kept, {**images, **found}, frozenset(found))


def _light(
    whole: Joint,
    sums: Sequence[BlockSums],
    kept: Sequence[int],
    images: Mapping[str, Columns],
    estimated: frozenset[str] = frozenset(),
) -> SteadyLight:
    blocks = tuple(whole.header.blocks[b] for b in kept)
    left = tuple(sums[b] for b in kept)
    header = whole.header.model_copy(update={"blocks": blocks})
    sessions = tuple(whole.sessions[b] for b in kept) if whole.sessions else ()
    table = conditions_table(
        header, [each.n_lines for each in left], images, estimated=estimated, sessions=sessions
    )
    return SteadyLight(left, table)


def _radiance(sums: Sequence[BlockSums], blocks: Sequence[Block], base: Baseline) -> Columns | None:
    """Return what radiance a scene shows, (n_columns,); None at one exposure, or if it moves."""
    if len({block.exposure_us for block in blocks}) < 2 or (base.slope <= 0).any():
        return None
    # Shot noise weighs a mean by lines over signal: signals add up, and so do doses.
    lines = np.array([each.n_lines for each in sums], np.float64)
    above = sum(n * (each.mean_dn - base.offset_dn) for n, each in zip(lines, sums, strict=True))
    exposed = sum(n * block.exposure_us for n, block in zip(lines, blocks, strict=True))
    radiance = np.maximum(above / (base.slope * exposed), 0.0)
    for each, block in zip(sums, blocks, strict=True):
        signal = base.slope * radiance * block.exposure_us
        expected = float(
            np.mean(base.read_variance_dn2) + base.gain_dn_per_e.mean() * signal.mean()
        )
        if float(each.products.squares.mean()) / max(each.n_lines - 1, 1) > STEADY * expected:
            return None
    return np.asarray(radiance.ravel())
