"""Simulates a recording, block by block in the order of time."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.random import Generator

from calib.arrays import Lines, RawLines
from calib.errors import InputError
from calib.forward.chain import expected_left
from calib.forward.conditions import Conditions
from calib.forward.left import Left
from calib.forward.model import Model
from calib.forward.scene import as_scene
from calib.forward.schedule import AMBIENT_C, ScheduledBlock, line_period_us, schedule
from calib.recording.frame_codes import sample_shape
from calib.recording.header import Block


def simulate(
    model: Model,
    blocks: Sequence[Block],
    rng: Generator,
    *,
    frame_lines: int,
    scenes: Mapping[str, Lines] | None = None,
    settle_s: float = 0.0,
) -> Iterator[tuple[Block, Iterator[RawLines]]]:
    """Yield each block, its unknowns filled in, with an iterator over its frames.

    Each block draws from a generator of its own, spawned from `rng`, so that its lines do not
    depend on how many frames of the blocks before were asked for. Where the sensor remembers, a
    block finds what those before it leave on average, the first a sensor at rest.

    Args:
        model: The camera and its light.
        blocks: In the order of time. Where None, `started_s`, `sensor_temperature_c` (25), `lines`
            (one frame) and `radiance` (nominal, of the lamps that burn) are filled in.
        rng: The same state gives the same recording.
        frame_lines: Lines per frame; a block's last frame holds what is left. Of an area sensor,
            how many frames come at once.
        scenes: The radiance images that blocks of kind `scene` name, (lines, *sample) each, or
            one sample.
        settle_s: How long the bench waits after switching lamps, where `started_s` is None.

    Raises:
        InputError: At once, where the blocks do not fit the model or each other.
    """
    if frame_lines < 1:
        raise InputError(f"frame_lines is {frame_lines}; give 1 or more.", code="bad-frame-lines")
    timed = schedule(model, blocks, frame_lines=frame_lines, settle_s=settle_s)
    shots = [_Shot(model, one, _image(one, model, scenes or {}), frame_lines) for one in timed]
    return _blocks(shots, rng.spawn(len(timed)))


@dataclass(frozen=True)
class _Shot:
    """A block and what it sees: `image` is its radiance where it is a scene."""

    model: Model
    one: ScheduledBlock
    image: Lines | None
    frame_lines: int

    def frames(self, rng: Generator, left: Left | None) -> Iterator[RawLines]:
        """Yield the frames, (frame_lines, *sample) each; the first finds `left`."""
        for at, part in self._stretches():
            drawn = self.model.draw(replace(at, before=left), rng, part)
            left = drawn.left
            yield drawn.dn

    def expected_left(self, left: Left | None) -> Left | None:
        """Return what the block leaves on average where it finds `left`."""
        for at, part in self._stretches():
            scene = as_scene(part, at.n_lines, sample_shape(self.model.camera))
            left = expected_left(self.model.effects, scene, replace(at, before=left))
        return left

    def _stretches(self) -> Iterator[tuple[Conditions, Lines | None]]:
        """Yield each frame's conditions and its part of the radiance image."""
        for first in range(0, self.one.n_lines, self.frame_lines):
            stop = min(first + self.frame_lines, self.one.n_lines)
            image = self.image
            part = image if image is None or len(image) == 1 else image[first:stop]
            yield _conditions(self.model, self.one, first, stop), part


def _blocks(
    shots: Sequence[_Shot], generators: Sequence[Generator]
) -> Iterator[tuple[Block, Iterator[RawLines]]]:
    left = None
    for shot, rng in zip(shots, generators, strict=True):
        yield shot.one.block, shot.frames(rng, left)
        if shot.model.remembers:
            left = shot.expected_left(left)


def _image(one: ScheduledBlock, model: Model, scenes: Mapping[str, Lines]) -> Lines | None:
    """Return the radiance image that a block of kind `scene` names, None for other blocks."""
    block = one.block
    if block.kind != "scene":
        return None
    if block.scene is None or block.scene not in scenes:
        raise InputError(
            f"block {block.block}: its scene {block.scene!r} is not given; known: "
            f"{', '.join(scenes) or 'none'}.",
            code="scene-missing",
        )
    return as_scene(scenes[block.scene], one.n_lines, sample_shape(model.camera))


def _conditions(model: Model, one: ScheduledBlock, first: int, stop: int) -> Conditions:
    """Return what holds during lines `first` to `stop`; lamps as in the middle of them."""
    period_us = line_period_us(model)
    times_s = one.started_s + np.arange(first, stop, dtype=np.float64) * (period_us * 1e-6)
    temperature_c = one.block.sensor_temperature_c
    return Conditions(
        exposure_us=one.block.exposure_us,
        line_period_us=period_us,
        line_times_s=times_s,
        lamps=one.lamps.emissions(float(times_s.mean())),
        level=one.block.level,
        capped=one.block.kind == "dark",
        sensor_temperature_c=AMBIENT_C if temperature_c is None else temperature_c,
        gain_db=model.camera.gain_db,
        black_level_dn=model.camera.black_level_dn,
    )
