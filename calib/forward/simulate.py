"""Simulates a recording, block by block in the order of time."""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from numpy.random import Generator

from calib.arrays import Lines, RawLines
from calib.errors import InputError
from calib.forward.conditions import Conditions
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
    depend on how many frames of the blocks before were asked for.

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
    images = [_image(one, model, scenes or {}) for one in timed]
    generators = rng.spawn(len(timed))
    return (
        (one.block, _frames(model, one, image, frame_lines, generator))
        for one, image, generator in zip(timed, images, generators, strict=True)
    )


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


def _frames(
    model: Model, one: ScheduledBlock, image: Lines | None, frame_lines: int, rng: Generator
) -> Iterator[RawLines]:
    """Yield the block's frames, (frame_lines, *sample) each."""
    for first in range(0, one.n_lines, frame_lines):
        stop = min(first + frame_lines, one.n_lines)
        part = image if image is None or len(image) == 1 else image[first:stop]
        yield model.draw(_conditions(model, one, first, stop), rng, part).dn


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
