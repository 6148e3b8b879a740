"""What holds of every departure in a model: in its file, in a recording; and what a plan lacks."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from calib.forward.departure import Departure
from calib.forward.effects.catalogue import CATALOGUE, effect_named
from calib.forward.model import Model
from calib.forward.simulate import simulate
from calib.recording.header import Block, CameraHeader

DEMO = Model.preset("demo")
TWO_TAPS = CameraHeader(columns=64, bit_depth=12, taps=2, tap_layout="odd_even")
every_departure = pytest.mark.parametrize(
    "kind", [k for k in CATALOGUE if issubclass(k, Departure)], ids=lambda kind: kind.name
)


def block(kind: str, level: float = 0, **given: Any) -> Block:
    return Block(block="", kind=kind, level=level, **({"exposure_us": 50.0, "lines": 30} | given))  # type: ignore[arg-type]


DARK, DIM, BRIGHT = block("dark"), block("flat", 1), block("flat", 3)


@pytest.mark.parametrize("rows", [None, 3], ids=["line", "frame"])
@every_departure
def test_a_departure_goes_through_a_model_file_into_a_recording(
    kind: type[Departure], rows: int | None
) -> None:
    camera = DEMO.camera.model_copy(update={"columns": 32, "rows": rows})
    model = replace(DEMO, camera=camera).with_effect(kind())
    read = Model.loads(model.dumps())
    assert read == model
    blocks = [replace_name(b, str(k)) for k, b in enumerate((DARK, BRIGHT, DARK, DIM))]

    def recorded(of: Model, seed: int) -> list[Any]:
        drawn = simulate(of, blocks, np.random.default_rng(seed), frame_lines=20)
        return [np.concatenate(list(frames)) for _, frames in drawn]

    first, again, other = recorded(model, 3), recorded(read, 3), recorded(model, 4)
    sample = (32,) if rows is None else (rows, 32)
    assert all(dn.shape == (30, *sample) and dn.dtype == np.uint16 for dn in first)
    assert all(np.array_equal(a, b) for a, b in zip(first, again, strict=True))
    assert not any(np.array_equal(a, b) for a, b in zip(first, other, strict=True))


def replace_name(of: Block, name: str) -> Block:
    return of.model_copy(update={"block": name})


ONE_LINE = block("flat", 1, lines=1)
LACKS: dict[str, tuple[list[list[Block]], list[Block], str]] = {
    "lag": ([[DARK], [ONE_LINE]], [DIM], "a flat"),
    "persistence": ([[DIM], [DARK, DIM, BRIGHT]], [BRIGHT, DARK], "a darker block after"),
    "cti": ([[DARK], [ONE_LINE]], [DIM], "a flat"),
    "interpixel_capacitance": ([[DARK], [ONE_LINE]], [DIM], "a flat"),
    "tap_crosstalk": ([[DARK], [ONE_LINE]], [DIM], "a flat"),
    "tap_gain_drift": ([[DARK, DIM]], [DIM, DIM], "two flats"),
    "gain_drift": ([[DARK, DIM]], [DIM, DIM], "two flats"),
    "offset_drift": ([[DARK, DIM]], [DARK, DIM, DARK], "three blocks"),
    "offset_temperature": (
        [[DARK, DIM, DARK]],
        [block("dark", sensor_temperature_c=t) for t in (20.0, 21.0, 22.0)],
        "sensor temperatures",
    ),
    "rts_pixels": ([[ONE_LINE]], [DARK], "a block of three lines"),
    "heavy_tailed_noise": ([[ONE_LINE]], [DARK], "a block of four lines"),
    "duplicated_lines": ([[ONE_LINE]], [DARK], "a block of two lines"),
    "line_noise": ([[ONE_LINE]], [DARK], "a block of two lines"),
    "banding": ([[ONE_LINE]], [block("dark", lines=None)], "a block of two lines"),
}


@pytest.mark.parametrize(("name", "case"), LACKS.items(), ids=LACKS)
def test_a_plan_that_cannot_show_an_effect_is_told_what_it_lacks(
    name: str, case: tuple[list[list[Block]], list[Block], str]
) -> None:
    kind = effect_named(name)
    assert issubclass(kind, Departure)
    short, enough, words = case
    lacks = [kind.why_not_testable(blocks, TWO_TAPS) for blocks in short]
    assert all(lack is not None and lack.startswith("needs ") for lack in lacks)
    assert words in str(lacks[0])
    assert kind.why_not_testable(enough, TWO_TAPS) is None


@pytest.mark.parametrize("name", ["tap_crosstalk", "tap_gain_drift"])
def test_one_tap_shows_nothing_of_taps(name: str) -> None:
    one = TWO_TAPS.model_copy(update={"taps": 1, "tap_layout": "single"})
    kind = effect_named(name)
    assert issubclass(kind, Departure)
    assert kind.why_not_testable([DIM, DIM], one) == "needs a camera of two taps or more"


@pytest.mark.parametrize("name", ["cti", "interpixel_capacitance", "line_noise"])
def test_one_column_shows_nothing_of_neighbours(name: str) -> None:
    one = TWO_TAPS.model_copy(update={"columns": 1})
    kind = effect_named(name)
    assert issubclass(kind, Departure)
    assert kind.why_not_testable([DIM], one) == "needs two columns or more"
