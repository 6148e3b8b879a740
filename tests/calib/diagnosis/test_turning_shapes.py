"""A converter's smooth error is looked for where it turns, and only there."""

import pytest
from numpy.random import default_rng

from calib.diagnosis.shapes.turning_shapes import turning_shapes
from calib.forward.effect import Effect
from calib.forward.effects.adc_inl import AdcInl
from calib.forward.effects.nonlinearity import Nonlinearity
from tests.calib.diagnosis.recordings import plain_model, plan, recorded


@pytest.mark.parametrize(
    ("effect", "turns"),
    [
        (AdcInl(0.0, 0.0, 0.0, (3.0,)), True),
        (AdcInl(0.0, 0.0, 3.0), True),
        (Nonlinearity(1e-5), False),
    ],
    ids=["four half waves", "three", "a bow"],
)
def test_what_bends_one_way_is_no_converter_s_error(effect: Effect, turns: bool) -> None:
    rng = default_rng()
    evidence = recorded(plain_model(96), plan(rng, 100, twice=0), rng, (effect,))
    assert (len(turning_shapes(evidence)) == 1) == turns
