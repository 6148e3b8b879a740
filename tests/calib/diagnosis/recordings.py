"""Simulated recordings for the diagnosis' tests, drawn by the forward model."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.random import Generator

from calib.arrays import Columns
from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.evidence.fitted_evidence import evidence_of
from calib.diagnosis.recorded.conditions_table import conditions_table
from calib.diagnosis.recorded.sensor import Sensor
from calib.diagnosis.statistics.gather import block_sums
from calib.forward.effect import Effect
from calib.forward.effects.adc import Adc
from calib.forward.effects.full_well import FullWell
from calib.forward.effects.illumination import Illumination
from calib.forward.effects.offset import Offset
from calib.forward.effects.read_noise import ReadNoise
from calib.forward.effects.responsivity import Responsivity
from calib.forward.effects.shot_noise import ShotNoise
from calib.forward.effects.system_gain import SystemGain
from calib.forward.effects.vignette import Vignette
from calib.forward.model import Model
from calib.forward.simulate import simulate
from calib.recording.header import Block, CameraHeader, RecordingHeader, SourceHeader


def plain_model(
    columns: int = 256,
    *,
    bits: int = 12,
    taps: int = 1,
    layout: str = "single",
    rows: int | None = None,
) -> Model:
    """Return a sensor of the baseline alone, whose read noise is 0.6 DN or more."""
    gain = max(0.1 * 2.0 ** (bits - 12), 0.05)
    light = 2.0 ** (bits - 12) * 0.1 / gain
    return Model(
        CameraHeader(
            columns=columns, rows=rows, bit_depth=bits, taps=taps, tap_layout=layout,
            line_period_us=1400.0,
        ),
        SourceHeader(kind="sphere", lamps=4),
        (
            Illumination((1.0, 1.05, 0.97, 1.02)),
            Vignette(focal_length_columns=columns * 1.2),
            Responsivity(10.0 * light, 0.01),
            ShotNoise(),
            FullWell(40_000.0),
            ReadNoise(12.0),
            SystemGain(gain),
            Offset(64.0 if bits > 8 else 20.0, 1.0),
            Adc(bits),
        ),
    )  # fmt: skip


def plan(
    rng: Generator, n_lines: int = 100, *, temperatures: bool = True, twice: int = 6
) -> list[Block]:
    """Return darks and three levels at three exposures, some twice, in an order of chance."""
    wanted: list[tuple[str, float, float]] = []
    for exposure in (200.0, 500.0, 1000.0):
        wanted += [
            ("dark", exposure, 0.0),
            *(("flat", exposure, level) for level in (1.0, 2.0, 3.0)),
        ]
    wanted += wanted[:twice]
    order = rng.permutation(len(wanted))
    return [
        Block(
            block=f"{k:03d}", kind=wanted[j][0], exposure_us=wanted[j][1], level=wanted[j][2],
            lines=n_lines,
            sensor_temperature_c=25.0 + 6.0 * float(np.sin(1.7 * k)) if temperatures else 25.0,
        )
        for k, j in enumerate(order)
    ]  # fmt: skip


def recorded(
    model: Model,
    blocks: Sequence[Block],
    rng: Generator,
    effects: Sequence[Effect] = (),
    scenes: Mapping[str, Columns] | None = None,
) -> Evidence:
    for effect in effects:
        model = model.with_effect(effect)
    sensor = Sensor(model.camera)
    sums, taken = [], []
    drawn = simulate(model, blocks, rng, frame_lines=4096, scenes=scenes, settle_s=0.5)
    for block, frames in drawn:
        lines = np.concatenate(list(frames))
        samples = lines.reshape(len(lines), sensor.n_rows, sensor.n_columns)
        sums.append(block_sums(samples, sensor, 1 << 20, uniform=block.kind != "scene"))
        taken.append(block)
    header = RecordingHeader(camera=model.camera, source=model.source, blocks=tuple(taken))
    table = conditions_table(header, [each.n_lines for each in sums], scenes)
    return evidence_of(sums, table, sensor)
