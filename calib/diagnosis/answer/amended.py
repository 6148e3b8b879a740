"""The model that a diagnosis arrives at, as a file that `simulate` and the mock bench load."""

import numpy as np

from calib.diagnosis.answer.empirical import empirical_term, with_term
from calib.diagnosis.baseline.baseline import Baseline
from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.naming.model import Model as Found
from calib.diagnosis.naming.rebase import rebased
from calib.errors import InputError
from calib.forward.effect import Effect
from calib.forward.effects.adc import Adc
from calib.forward.effects.illumination import Illumination
from calib.forward.effects.offset import Offset
from calib.forward.effects.read_noise import ReadNoise
from calib.forward.effects.responsivity import Responsivity
from calib.forward.effects.shot_noise import ShotNoise
from calib.forward.effects.system_gain import SystemGain
from calib.forward.model import Model
from calib.recording.header import SourceHeader

MOST_PIXELS = 1 << 18
"""Values of single pixels are written as text, and more of them make no file to read."""


def amended_model(
    found: Found, evidence: Evidence, source: SourceHeader, given: Model | None = None
) -> Model:
    """Return the fitted baseline, or `given`, with the effects that were found.

    What remains of the means beside the former is carried by a term that is called `empirical`.
    """
    term = empirical_term(found, evidence) if given is None else None
    model = given
    if model is None:
        base = beside(found, evidence)
        base = base if term is None else with_term(base, term, evidence)
        model = _fitted(base, evidence, source)
    for member in found.members:
        model = model.with_effect(member.effect)
    return model if term is None else model.with_effect(term.effect)


def beside(found: Found, evidence: Evidence) -> Baseline:
    """Return the baseline beside what was found, its last step done."""
    if found.change is None:
        return found.baseline
    return rebased(found.baseline, found.observed - found.change, evidence)


def _fitted(base: Baseline, evidence: Evidence, source: SourceHeader) -> Model:
    sensor = evidence.sensor
    if sensor.n_pixels > MOST_PIXELS:
        raise InputError(
            f"a model file holds values of {MOST_PIXELS} pixels at most, and this camera has "
            f"{sensor.n_pixels}: name the model that it was simulated with by --model",
            code="too-many-pixels",
        )
    gain = np.where(base.gain_dn_per_e > 0, base.gain_dn_per_e, 1.0)
    electrons = base.slope / gain[sensor.tap]
    mean = max(float(electrons.mean()), 1e-12)
    overall = float(gain[sensor.tap].mean())
    taps = sensor.n_taps > 1
    layout = sensor.camera.tap_layout if taps else "single"
    read = np.sqrt(np.maximum(base.read_variance_dn2 - 1.0 / 12.0, 0.0)) / gain
    effects: tuple[Effect, ...] = (
        Illumination(evidence.table.lamp_radiance),
        Responsivity(mean, prnu=tuple(np.clip(electrons / mean, 0.0, 100.0).ravel().tolist())),
        ShotNoise(),
        ReadNoise(float(read.mean())),
        SystemGain(overall, tuple((gain / overall).tolist()) if taps else (), layout),
        Offset(pattern_dn=tuple(base.offset_dn.ravel().tolist())),
        Adc(sensor.camera.bit_depth),
    )
    neutral = sensor.camera.model_copy(update={"gain_db": 0.0, "black_level_dn": 0.0})
    return Model(neutral, source, effects)
