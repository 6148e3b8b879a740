"""A scene of unknown radiance at two exposures: deferred charge shows, what is linear does not."""

from dataclasses import replace

import numpy as np
from numpy.random import default_rng

from calib.arrays import Lines
from calib.diagnosis.baseline.nuisance import scene_blocks
from calib.diagnosis.baseline.scenes import with_steady_light
from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.evidence.fitted_evidence import evidence_of
from calib.diagnosis.recorded.joint import joint
from calib.diagnosis.recorded.sensor import Sensor
from calib.diagnosis.signatures.changes import change_of
from calib.diagnosis.simulation.fitted_responder import responder_of
from calib.diagnosis.statistics.gather import block_sums
from calib.forward.departure import Departure
from calib.forward.effects.cti import Cti
from calib.forward.effects.interpixel_capacitance import InterpixelCapacitance
from calib.forward.scene import bar
from calib.forward.simulate import simulate
from calib.recording.header import Block, RecordingHeader
from tests.calib.diagnosis.recordings import plain_model

COLUMNS, LINES = 96, 1000
CTI, CAPACITANCE = Cti(per_transfer=8e-4, partition_noise=0.0), InterpixelCapacitance(0.012)
ROWS = [("dark", t, 0.0) for t in (200.0, 1000.0)] + [
    ("flat", t, 2.0) for t in (200.0, 600.0, 1000.0)
]


def seen(
    *effects: Departure, image: Lines | None = None, exposures: tuple[float, ...] = (200.0, 1000.0)
) -> Evidence:
    """Return the evidence of flats, darks and a bar that nobody knows the radiance of."""
    model = plain_model(COLUMNS)
    for effect in effects:
        model = model.with_effect(effect)
    rows = [*ROWS, *(("scene", t, 0.0) for t in exposures)]
    blocks = [
        Block.model_validate(
            {"block": str(k), "kind": kind, "exposure_us": t, "level": level, "lines": LINES,
             "scene": "target" if kind == "scene" else None}
        )
        for k, (kind, t, level) in enumerate(rows)
    ]  # fmt: skip
    scenes = {"target": 2.0 * bar(COLUMNS) if image is None else image}
    drawn = simulate(model, blocks, default_rng(), frame_lines=4096, scenes=scenes)
    sensor, sums, taken = Sensor(model.camera), [], []
    for block, frames in drawn:
        lines = np.concatenate(list(frames))[:, None, :]
        sums.append(block_sums(lines, sensor, 1 << 16, uniform=block.kind != "scene"))
        taken.append(block)
    header = RecordingHeader(camera=model.camera, blocks=tuple(taken))
    light = with_steady_light(joint([header]), sums, {})
    return evidence_of(light.sums, light.table, sensor)


def scene_part(evidence: Evidence, means: Lines) -> Lines:
    """Return a whitened vector of means in the scene's blocks alone."""
    only = replace(evidence, baseline=evidence.baseline)
    return np.asarray(only.space.project(means)[scene_blocks(evidence.table)])


def test_a_sharp_edge_leaves_nothing_in_a_camera_that_is_linear() -> None:
    for effects in ((), (CAPACITANCE,)):
        evidence = seen(*effects)
        assert scene_blocks(evidence.table).sum() == 2
        residual = scene_part(evidence, evidence.observed().means)
        # A pixel's two means less a slope of the scene's own, and offsets known by five blocks.
        freedom = COLUMNS
        assert (residual**2).sum() < freedom + 5.0 * np.sqrt(2.0 * freedom)


def test_deferred_charge_trails_an_edge_the_more_the_weaker_it_is_exposed() -> None:
    evidence = seen(CTI)
    parts = {}
    for effect in (CTI, CAPACITANCE):
        change = change_of((effect,), evidence, responder_of(evidence))
        parts[effect.name] = scene_part(evidence, change.means)
    length, other = (float(np.linalg.norm(part)) for part in parts.values())
    assert length > 4.0
    # Capacitance leaves nothing there at any strength.
    assert other < 0.25 * length
    residual = scene_part(evidence, evidence.observed().means)
    along = float((residual * parts["cti"]).sum()) / length
    # The scene as it is seen has the trail in it already: twice the share that the edge defers.
    share = float(CTI.deferred_share(np.full((1, COLUMNS), CTI.reference_e)).max())
    assert abs(along - length) < 4.0 + 2.0 * share * length


def test_a_scene_that_moves_or_is_seen_at_one_exposure_is_left_out() -> None:
    moving = np.tile(2.0 * bar(COLUMNS), (LINES, 1)) * np.linspace(0.5, 1.5, LINES)[:, None]
    assert len(seen(image=moving).table.blocks) == len(ROWS)
    assert len(seen(exposures=(400.0, 400.0)).table.blocks) == len(ROWS)
