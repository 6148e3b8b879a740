"""Draws a plan's recording from a forward model, without bench or time."""

import tempfile
from collections.abc import Callable, Mapping
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from calib.errors import InputError
from calib.forward.model import Model
from calib.forward.pattern import pixel_count
from calib.forward.simulate import simulate
from calib.recording.durable import refuse_existing
from calib.recording.folder import export_folder
from calib.recording.header import Block, RecordingHeader
from calib.recording.new_recording import new_recording
from calib.recording.open import open_recording
from calib.recording.protocol import Recording
from calib.recording.scene_images import read_scene
from calib.recording.writer import RecordingWriter
from service.plan.expand import blocks as blocks_of
from service.plan.header import recording_header
from service.plan.model import Plan
from service.plan.region import Region

Scenes = Mapping[str, NDArray[np.float64]]
Progress = Callable[[float], None]
_PIXELS_AT_ONCE = 1 << 24
"""An area sensor's frames are drawn together up to so many: what they share is worked out once."""


def simulate_recording(
    model: Model,
    plan: Plan,
    out: Path,
    *,
    seed: int | None,
    scenes_folder: Path,
    progress: Progress | None = None,
) -> Recording:
    """Write the recording that `model` gives under `plan`, whole or not at all.

    Args:
        model: The camera and its light.
        plan: What is measured; its camera settings go before the model's.
        out: An .h5 file, or a folder where the name has no ending.
        seed: Of all randomness; None takes one from the system.
        scenes_folder: Where the radiance images are that the plan names.
        progress: Told the share of blocks done.

    Raises:
        InputError: Model and plan do not fit each other, or `out` is there already.
    """
    if out.suffix != ".h5":
        refuse_existing(out)
        with tempfile.TemporaryDirectory(prefix="darkflat-") as folder:
            file = Path(folder) / "recording.h5"
            simulate_recording(
                model, plan, file, seed=seed, scenes_folder=scenes_folder, progress=progress
            )
            return export_folder(open_recording(file), out)
    with new_recording(out) as partial:
        _draw(
            _as_planned(model, plan),
            plan,
            partial,
            seed=seed,
            scenes_folder=scenes_folder,
            progress=progress,
        )
    return open_recording(out)


def _as_planned(model: Model, plan: Plan) -> Model:
    """Return the model with its camera set as the plan wants it."""
    wanted, camera = plan.camera, model.camera
    if wanted.bit_depth != camera.bit_depth:
        msg = (
            f"the plan's pixel format {wanted.pixel_format} has {wanted.bit_depth} bits, the"
            f" model's camera {camera.bit_depth}; change camera.pixel_format in the plan"
        )
        raise InputError(msg, code="plan-does-not-fit-model")
    if camera.rows is not None and (plan.frame_lines or 1) > 1:
        msg = (
            f"the plan's frame_lines is {plan.frame_lines}, but an area sensor's is 1; leave it out"
        )
        raise InputError(msg, code="plan-does-not-fit-model")
    settings = {
        "line_period_us": wanted.line_period_us,
        "gain_db": wanted.gain_db,
        "black_level_dn": wanted.black_level_dn,
    }
    return replace(model, camera=camera.model_copy(update=settings))


def _draw(
    model: Model,
    plan: Plan,
    out: Path,
    *,
    seed: int | None,
    scenes_folder: Path,
    progress: Progress | None,
) -> None:
    blocks = blocks_of(plan)
    region = Region.of(plan.camera, model.camera)
    scenes = _scenes(blocks, scenes_folder, model.camera.columns)
    is_area = region.n_rows is not None
    at_once = max(1, _PIXELS_AT_ONCE // pixel_count(model.camera))
    drawn = simulate(
        model,
        blocks,
        np.random.default_rng(seed),
        frame_lines=at_once if is_area else plan.lines_per_frame,
        scenes=scenes,
        settle_s=plan.lamps.ramp_s + plan.settle.stable_for_s,
    )
    header = _header(model, plan, region)
    frame_lines = 1 if is_area else plan.lines_per_frame
    with RecordingWriter.create(
        out, header, frame_lines, plan=plan.dumps(), scenes=scenes
    ) as writer:
        for done, (block, frames) in enumerate(drawn, start=1):
            writer.begin_block(block)
            for dn in frames:
                for frame in region.cut(dn) if is_area else (region.cut(dn),):
                    writer.append(frame)
            writer.end_block(block)
            if progress is not None:
                progress(done / len(blocks))


def _header(model: Model, plan: Plan, region: Region) -> RecordingHeader:
    """Return the plan's header; what it leaves open is the model's."""
    planned = recording_header(
        plan,
        columns=region.n_columns,
        rows=region.n_rows,
        first_column=region.first_column,
        first_row=region.first_row,
        sensor_columns=model.camera.columns,
        sensor_rows=model.camera.rows,
    )
    known = model.camera.model_dump(exclude_none=True)
    stated = planned.camera.model_dump(exclude_defaults=True)
    camera = planned.camera.model_validate(
        {"started_at": datetime.now(UTC).replace(microsecond=0), **known, **stated}
    )
    left_open = {"radiance_unit", "lamps"} - plan.source.model_fields_set
    lit_by = model.source.model_dump(include=left_open, exclude_none=True)
    source = planned.source.model_copy(update=lit_by)
    return planned.model_copy(update={"camera": camera, "source": source})


def _scenes(blocks: tuple[Block, ...], folder: Path, columns: int) -> Scenes:
    names = dict.fromkeys(block.scene for block in blocks if block.scene is not None)
    return {name: read_scene(folder, name, columns) for name in names}
