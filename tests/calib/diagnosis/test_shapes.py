from dataclasses import replace
from math import inf

import pytest

from calib.diagnosis.shapes.grids import Scales
from calib.diagnosis.shapes.of_effects import shapes_of
from calib.diagnosis.shapes.shape import Shape
from calib.forward.effects.adc_dnl import AdcDnl
from calib.forward.effects.banding import Banding
from calib.forward.effects.cti import Cti
from calib.forward.effects.stuck_bit import StuckBit
from calib.recording.header import CameraHeader


def scales(tones_hz: tuple[float, ...] = ()) -> Scales:
    return Scales(CameraHeader(columns=64, bit_depth=12), 60.0, 1e-3, 2e4, 4.0, tones_hz)


def test_the_only_tone_that_stands_out_is_looked_for() -> None:
    tried = {shape.template for shape in shapes_of(Banding, scales((73_259.8,)))}
    assert {each.frequency_hz for each in tried if isinstance(each, Banding)} == {73_259.8}


@pytest.mark.parametrize(("taps", "layout"), [(1, "single"), (2, "odd_even"), (4, "quarters")])
def test_registers_that_are_looked_for_are_the_taps(taps: int, layout: str) -> None:
    camera = CameraHeader(columns=64, bit_depth=12, taps=taps, tap_layout=layout, readout="both")  # type: ignore[arg-type]
    tried = {shape.template for shape in shapes_of(Cti, replace(scales(), camera=camera))}
    assert {(e.tap_layout, e.readout) for e in tried if isinstance(e, Cti)} == {(layout, "both")}


def test_a_strength_ends_where_a_parameter_does() -> None:
    bit = Shape(StuckBit(), (("probability", 0.4, 0.0),), two_sided=False)
    codes = Shape(AdcDnl(0.0), (("widths_dn", (0.5, -0.5), 1.0),), two_sided=False)
    assert (bit.most, codes.most) == (2.5, 2.0)
    assert Shape(bit.template, bit.varied, two_sided=True).most == inf
