"""The blocks of a recording in the light, and around the response, that an estimation found."""

from collections.abc import Sequence

import numpy as np

from calib.forward.effects.read_noise import ReadNoise
from calib.forward.effects.shot_noise import ShotNoise
from calib.forward.effects.system_gain import SystemGain
from calib.forward.effects.vignette import Vignette
from calib.forward.model import Model
from calib.radiometric.departures.expected_blocks import LitBlock
from calib.radiometric.departures.fitted_chain import FittedChain, Response, carried
from calib.radiometric.departures.recorded_blocks import RecordedBlock
from calib.radiometric.estimation.parts import Parts
from calib.recording.block_statistics import BlockStatistics


def lit_blocks(
    blocks: Sequence[RecordedBlock],
    statistics: Sequence[BlockStatistics],
    parts: Parts,
    model: Model,
    gain_db: float,
) -> tuple[LitBlock, ...]:
    """Return the blocks with the light and the response that `parts` found.

    A scene's light, which no fit knows, is what its mean lines show.
    """
    estimate, scale = parts.estimate, parts.scale.radiance_of_reference
    slope = estimate.fit.slope / scale
    x_us = iter(estimate.fit.x_us.tolist())
    lit = []
    for one, observed in zip(blocks, statistics, strict=True):
        t = one.block.exposure_us
        response = Response.filled(slope, estimate.fit.offset + estimate.current.dn_per_us * t)
        light = np.zeros(len(slope))
        if one.block.kind == "flat" and observed.n_lines:
            radiance = next(x_us) / t * scale
            light += radiance if np.isfinite(radiance) else (one.block.radiance or 0.0)
        elif one.block.kind == "scene":
            above = observed.mean_dn - response.dark_dn
            light = np.maximum(above, 0.0) / (response.slope * t)
        lit.append(LitBlock(one, _chain(model, response, gain_db), light))
    return tuple(lit)


def _chain(model: Model, response: Response, gain_db: float) -> FittedChain:
    vignette, gain = model.effect("vignette"), model.effect("system_gain")
    noise = [e for e in model.effects if isinstance(e, ShotNoise | ReadNoise)]
    return FittedChain(
        carried(model.effects),
        vignette if isinstance(vignette, Vignette) else Vignette(),
        gain if isinstance(gain, SystemGain) else SystemGain(1.0),
        gain_db,
        response,
        tuple(noise),
    )
