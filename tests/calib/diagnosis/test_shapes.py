from calib.diagnosis.naming.grids import Scales
from calib.diagnosis.naming.shapes import shapes_of
from calib.forward.effects.banding import Banding
from calib.recording.header import CameraHeader


def scales(tones_hz: tuple[float, ...] = ()) -> Scales:
    return Scales(CameraHeader(columns=64, bit_depth=12), 60.0, 1e-3, 2e4, 4.0, tones_hz)


def test_the_only_tone_that_stands_out_is_looked_for() -> None:
    tried = {shape.template for shape in shapes_of(Banding, scales((73_259.8,)))}
    assert {each.frequency_hz for each in tried if isinstance(each, Banding)} == {73_259.8}
