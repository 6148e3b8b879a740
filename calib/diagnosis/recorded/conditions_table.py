"""The conditions of a recording's blocks as arrays, with what is unknown filled in."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from calib.arrays import Columns
from calib.errors import NotDeterminedError
from calib.forward.conditions import Conditions
from calib.forward.schedule import AMBIENT_C
from calib.recording.header import Block, CameraHeader, RecordingHeader

DEFAULT_PERIOD_US = 1000.0
"""Of a camera that does not tell its line period, where no exposure is longer."""
MOST_LAMPS = 64
"""A level beyond this is a setting, no number of lamps."""


@dataclass(frozen=True)
class ConditionsTable:
    """One entry per block, (n_blocks,) each, in the order of acquisition.

    Attributes:
        blocks: As the recording says.
        camera: The camera.
        line_period_us: From line to line, or frame to frame.
        radiance: At the lens, nominal; the level where no radiance is told; 0 where capped.
        started_s: Wall time of the first line.
        n_lines: Lines, or frames.
        scenes: Radiance at the lens, (n_pixels,) each, of the blocks whose light has a pattern.
        estimated: Names of scenes whose radiance is what they show themselves.
        sessions: Where hours part recordings that are diagnosed together, which of them each
            block is of, from 0; empty where all are of one.
    """

    blocks: tuple[Block, ...]
    camera: CameraHeader
    line_period_us: float
    radiance: Columns
    started_s: Columns
    n_lines: Columns
    scenes: Mapping[int, Columns] = field(default_factory=dict)
    estimated: frozenset[str] = frozenset()
    sessions: tuple[int, ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        """The blocks' names."""
        return tuple(block.block for block in self.blocks)

    @property
    def exposure_us(self) -> Columns:
        """Exposure time."""
        return np.array([block.exposure_us for block in self.blocks])

    @property
    def level(self) -> Columns:
        """Lamps that burn, or the LED's setting; 0 in the dark."""
        return np.array([0.0 if block.kind == "dark" else block.level for block in self.blocks])

    @property
    def temperature_c(self) -> Columns:
        """Sensor temperature; that of the surroundings where it is unknown."""
        told = (block.sensor_temperature_c for block in self.blocks)
        return np.array([AMBIENT_C if t is None else t for t in told])

    @property
    def dark(self) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
        """True where the lens is capped."""
        return np.array([block.kind == "dark" for block in self.blocks])

    @property
    def dose(self) -> Columns:
        """Radiance times exposure, radiance us: what the baseline's signal is linear in."""
        return self.radiance * self.exposure_us

    def dose_of(self, shape: tuple[int, int]) -> NDArray[np.float64]:
        """Return the dose of each pixel, (n_blocks, *shape): that of scenes has their pattern."""
        uniform = np.broadcast_to(self.dose[:, None, None], (len(self.blocks), *shape))
        if not self.scenes:
            return uniform
        dose = uniform.copy()
        for b, radiance in self.scenes.items():
            dose[b] = radiance.reshape(shape) * self.blocks[b].exposure_us
        return dose

    def beyond_lamps(self, b: int, sample: tuple[int, ...]) -> NDArray[np.float64]:
        """Return what a scene's radiance has beyond the lamps' uniform one, (*sample,)."""
        if b not in self.scenes:
            return np.zeros(sample)
        return np.asarray(self.scenes[b].reshape(sample) - self.radiance[b])

    @property
    def mid_s(self) -> Columns:
        """Wall time of the middle of each block."""
        return np.asarray(self.started_s + self.n_lines * self.line_period_us * 0.5e-6)

    def at(self, b: int, lines: Columns) -> Conditions:
        """Return the conditions of lines `lines`, counted from the block's first, of block `b`."""
        block = self.blocks[b]
        dark = block.kind == "dark"
        return Conditions(
            exposure_us=block.exposure_us,
            line_period_us=self.line_period_us,
            line_times_s=self.started_s[b] + lines * (self.line_period_us * 1e-6),
            lamps=() if dark else self._emissions(block.level, float(self.radiance[b])),
            level=0.0 if dark else block.level,
            capped=dark,
            sensor_temperature_c=float(self.temperature_c[b]),
            gain_db=0.0,
            black_level_dn=0.0,
        )

    @cached_property
    def lamp_radiance(self) -> tuple[float, ...]:
        """Radiance of each lamp, so that the first n together give what level n is told to give.

        A source whose levels are no whole numbers is one lamp, of the radiance of level 1.
        """
        lit = (self.level > 0) & (self.radiance > 0)
        levels = np.unique(self.level[lit])
        if len(levels) == 0:
            return (1.0,)
        told = np.array([self.radiance[lit & (self.level == each)].mean() for each in levels])
        if not np.array_equal(levels, levels.round()) or levels[-1] > MOST_LAMPS:
            return (float((told * levels).sum() / (levels**2).sum()),)
        cumulated = np.interp(np.arange(levels[-1] + 1), [0.0, *levels], [0.0, *told])
        return tuple(np.diff(cumulated))

    def _emissions(self, level: float, radiance: float) -> tuple[float, ...]:
        lamps = self.lamp_radiance
        count = len(lamps) if len(lamps) == 1 else max(int(level), 1)
        return (radiance / max(sum(lamps[:count]), 1e-300),) * count


def conditions_table(
    header: RecordingHeader,
    n_lines: Sequence[int],
    images: Mapping[str, Columns] | None = None,
    *,
    estimated: frozenset[str] = frozenset(),
    sessions: tuple[int, ...] = (),
) -> ConditionsTable:
    """Return the table; NotDeterminedError where no line can be told apart by its light.

    Args:
        header: Of the recording.
        n_lines: Of each block.
        images: Radiance along the columns, by scene.
        estimated: Names of those that were estimated from the recording itself.
        sessions: Of each block; empty where all are of one.
    """
    blocks = header.blocks
    exposures = [block.exposure_us for block in blocks]
    period = header.camera.line_period_us or max(DEFAULT_PERIOD_US, *exposures)
    if not blocks:
        msg = "the recording has no blocks: record darks, and flats at several exposures"
        raise NotDeterminedError(msg, code="no-blocks")
    return ConditionsTable(
        blocks,
        header.camera,
        period,
        _radiances(blocks),
        _starts(blocks, n_lines, period),
        np.asarray(n_lines, np.float64),
        {
            b: images[block.scene]
            for b, block in enumerate(blocks)
            if images is not None and block.scene is not None and block.scene in images
        },
        estimated,
        sessions,
    )


def _radiances(blocks: Sequence[Block]) -> Columns:
    lit = [block for block in blocks if block.kind != "dark"]
    told = all(block.radiance is not None for block in lit if block.kind == "flat")
    chosen = ((b.radiance if told else b.level) or 0.0 for b in blocks)
    return np.array([0.0 if b.kind == "dark" else r for b, r in zip(blocks, chosen, strict=True)])


def _starts(blocks: Sequence[Block], n_lines: Sequence[int], period_us: float) -> Columns:
    free, starts = 0.0, []
    for block, n in zip(blocks, n_lines, strict=True):
        start = free if block.started_s is None else block.started_s
        starts.append(start)
        free = start + n * period_us * 1e-6
    return np.array(starts)
