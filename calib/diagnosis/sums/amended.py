"""The model that a diagnosis of sums arrives at, as a file that `simulate` loads."""

import numpy as np

from calib.diagnosis.recorded.conditions_table import conditions_table
from calib.diagnosis.sums.diagnose import SumsExamination
from calib.diagnosis.sums.names import departure, names_of
from calib.errors import NotDeterminedError
from calib.forward.effects.adc import Adc
from calib.forward.effects.illumination import Illumination
from calib.forward.effects.offset import Offset
from calib.forward.effects.read_noise import ReadNoise
from calib.forward.effects.responsivity import Responsivity
from calib.forward.effects.shot_noise import ShotNoise
from calib.forward.effects.system_gain import SystemGain
from calib.forward.model import Model


def amended_model(found: SumsExamination, given: Model | None = None) -> Model:
    """Return the fitted curve as a model of pixels that are all alike, or `given`, amended.

    Raises:
        NotDeterminedError: Without darks, or without exposures, no model follows from sums.
    """
    model = given if given is not None else _fitted(found)
    for name in names_of(found.model):
        model = model.with_effect(departure(name, found.fit.shape))
    return model


def _fitted(found: SumsExamination) -> Model:
    fit, header = found.fit, found.header
    means = fit.data.means
    if means is None:
        raise NotDeterminedError(
            "no model follows from these sums: add darks, and flats of one level at five "
            "exposures or more, or name the model that is to be amended by --model",
            code="no-model-from-sums",
        )
    table = conditions_table(header, [block.lines or 1 for block in header.blocks])
    lamps = table.lamp_radiance
    lit = table.level == means.levels[0]
    radiance = float(table.radiance[lit].mean())
    rate = float(fit.solution.parameters[len(fit.names)])
    gain = fit.shape.system_gain
    dark = found.measured.taps[0].points
    effects = (
        Illumination(lamps),
        Responsivity(rate / gain / radiance, prnu_std=0.0),
        ShotNoise(),
        ReadNoise(float(np.sqrt(max(fit.shape.read_variance_dn2, 0.0)) / gain)),
        SystemGain(gain),
        Offset(float(dark.mean_dn[dark.is_dark].mean()), pattern_std_dn=0.0),
        Adc(header.camera.bit_depth),
    )
    neutral = header.camera.model_copy(update={"gain_db": 0.0, "black_level_dn": 0.0})
    return Model(neutral, header.source, effects)
