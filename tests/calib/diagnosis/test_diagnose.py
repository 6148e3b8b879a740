import json

import numpy as np
import pytest
from numpy.random import default_rng

from calib.diagnosis.answer.amended import amended_model
from calib.diagnosis.baseline.requirements import check_can_be_diagnosed
from calib.diagnosis.given.given_model import parameters_off
from calib.errors import NotDeterminedError
from calib.forward.effect import Effect
from calib.forward.effects.interpixel_capacitance import InterpixelCapacitance
from calib.forward.effects.lag import Lag
from calib.forward.effects.nonlinearity import Nonlinearity
from calib.forward.model import Model
from calib.recording.header import Block, CameraHeader, RecordingHeader
from tests.calib.diagnosis.examinations import examined, small_model
from tests.calib.diagnosis.recordings import recorded


@pytest.mark.parametrize(
    "effect",
    [Nonlinearity(1e-6), Lag(0.004), InterpixelCapacitance(0.04)],
    ids=lambda effect: effect.name,
)
def test_an_effect_is_named_and_measured(effect: Effect) -> None:
    found = examined((effect,))
    diagnosis = found.diagnosis
    names = [candidate.effect for each in diagnosis.findings for candidate in each.candidates]
    assert effect.name in names
    assert diagnosis.verdict in {"explained", "ambiguous"}
    assert diagnosis.final.heldout_deviance < diagnosis.baseline.heldout_deviance - 30.0
    first = diagnosis.findings[0]
    if first.effect.name == effect.name:
        name, estimate = next(iter(first.parameters.items()))
        # Signatures of a few drawn lines scatter by a few per cent of their own.
        allowed = 5.0 * np.hypot(estimate.std, 0.02 * getattr(effect, name))
        assert abs(estimate.value - getattr(effect, name)) < allowed
    json.dumps(diagnosis.answer())


def test_a_clean_recording_is_consistent_and_agrees_with_its_model() -> None:
    found = [examined(run=run) for run in range(2)]
    # At most 5 % false alarms: two of two happen once in 400 runs.
    assert any(each.diagnosis.verdict == "consistent" for each in found)
    off = [p.name for each in found for p in each.diagnosis.model_parameters]
    assert off.count("system_gain.dn_per_e") < 2


def test_a_wrong_number_in_a_given_model_is_named_and_no_effect() -> None:
    wrong = Model.loads(small_model().dumps().replace("dn_per_e = 0.1", "dn_per_e = 0.108"))
    off = {p.name: p for p in parameters_off(wrong, examined().evidence)}
    assert "system_gain.dn_per_e" in off
    gain = off["system_gain.dn_per_e"]
    assert abs(gain.fitted - 0.1) < 5.0 * gain.std


def test_the_amended_model_draws_what_was_recorded() -> None:
    found = examined((Nonlinearity(1e-6),))
    source = small_model().source
    model = amended_model(found.model, found.evidence, source)
    again = Model.loads(model.dumps())
    rng = default_rng()
    evidence = recorded(again, list(found.evidence.table.blocks), rng)
    old, new = (np.stack([s.mean_dn for s in e.sums]) for e in (found.evidence, evidence))
    std = np.sqrt(2.0 * found.evidence.baseline.variance_dn2 / found.evidence.n[:, None, None])
    z = (new - old) / std
    # The fit of each pixel absorbs two of its 14 means.
    assert z.std() < 1.15


def test_what_cannot_be_diagnosed_is_told_in_a_sentence() -> None:
    camera = CameraHeader(columns=8, bit_depth=12)
    flat = Block(block="0", kind="flat", exposure_us=100.0, level=1.0)
    for blocks, word in (((), "no flats"), ((flat,), "one exposure")):
        with pytest.raises(NotDeterminedError, match=word):
            check_can_be_diagnosed(RecordingHeader(camera=camera, blocks=blocks))
    short = (
        flat.model_copy(update={"lines": 2}),
        flat.model_copy(update={"exposure_us": 9.0, "lines": 2}),
    )
    with pytest.raises(NotDeterminedError, match="2 lines"):
        check_can_be_diagnosed(RecordingHeader(camera=camera, blocks=short))
