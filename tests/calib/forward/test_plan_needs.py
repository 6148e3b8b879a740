"""A departure says what a plan lacks to show it at all, and is silent where it could show."""

import itertools

import pytest

from calib.forward.departure import Departure
from calib.forward.effects.catalogue import CATALOGUE, effect_named
from calib.recording.header import Block, CameraHeader

CAMERA = CameraHeader(columns=8, bit_depth=12, taps=2, tap_layout="odd_even")


def dark(exposure_us: float = 50.0, lines: int | None = 30, temperature_c: float = 25.0) -> Block:
    return Block(
        block="d",
        kind="dark",
        exposure_us=exposure_us,
        lines=lines,
        sensor_temperature_c=temperature_c,
    )


def flat(level: float = 1.0, exposure_us: float = 50.0, lines: int | None = 30) -> Block:
    return Block(block="f", kind="flat", exposure_us=exposure_us, level=level, lines=lines)


GROWTH = "needs darks at two exposures or more, or such flats with a dark or at two levels"
THREE = "needs three different signals or more, a dark being one"
NEEDS: dict[str, tuple[list[tuple[list[Block], str]], list[list[Block]]]] = {
    "lamp_drift": (
        [
            ([dark()], "needs a flat"),
            ([dark(), dark(), flat()], "needs a flat that is repeated, or " + THREE[6:]),
        ],
        [[flat(), flat(2), flat()], [dark(), flat(1), flat(2)]],
    ),
    "lamp_flicker": (
        [
            ([dark(lines=500)], "needs a flat of eight lines or more"),
            ([flat(lines=7)], "needs a flat of eight lines or more"),
        ],
        [[flat(lines=8)], [flat(lines=None)]],
    ),
    "level_nonadditivity": (
        [
            ([dark(), flat(2), flat(2, 20.0)], "needs flats at two levels or more"),
            (
                [flat(1), flat(2)],
                "needs a dark, or flats at two exposures or more, or flats at three levels or more",
            ),
        ],
        [[dark(), flat(1), flat(2)], [flat(1), flat(2), flat(3)], [flat(1), flat(2, 20.0)]],
    ),
    "stray_light": (
        [
            ([dark(), flat(1), flat(1, 20.0)], "needs flats at two levels or more"),
            ([flat(1), flat(2), flat(3)], "needs a dark, or flats at two exposures or more"),
        ],
        [[dark(), flat(1), flat(2)], [flat(1), flat(2, 20.0)]],
    ),
    "exposure_offset": (
        [
            ([dark(), dark(20.0), flat(1), flat(2)], "needs flats at two exposures or more"),
            ([flat(1), flat(1, 20.0)], "needs a dark, or flats at two levels or more"),
        ],
        [[dark(), flat(1), flat(1, 20.0)], [flat(1), flat(2, 20.0)]],
    ),
    "exposure_jitter": (
        [([dark(), flat(lines=1)], "needs a flat of two lines or more")],
        [[flat(lines=2)]],
    ),
    "dark_current": (
        [
            ([dark(), dark()], GROWTH),
            ([flat(1), flat(1, 20.0)], GROWTH),
            ([dark(), flat(1)], GROWTH),
        ],
        [
            [dark(), dark(20.0)],
            [dark(), flat(1), flat(1, 20.0)],
            [flat(1), flat(2, 20.0)],
        ],
    ),
    "dark_current_temperature": (
        [([dark(), dark(temperature_c=25.9)], "needs sensor temperatures 1 K apart or more")],
        [[dark(), dark(temperature_c=26.0)]],
    ),
    "brighter_fatter": (
        [([dark(), flat(lines=1)], "needs a flat of two lines or more")],
        [[flat(lines=2)]],
    ),
    "cosmic_rays": (
        [([flat(lines=2), dark(lines=2)], "needs a block of three lines or more")],
        [[dark(lines=3)]],
    ),
    "saturation_knee": (
        [([dark(), dark(20.0), flat(2, 50.0), flat(1, 100.0)], THREE)],
        [[dark(), flat(1), flat(2)], [flat(1), flat(2), flat(4)]],
    ),
    "adc_dnl": (
        [([dark(lines=1)], "needs a block of two lines or more")],
        [[dark(lines=2)]],
    ),
    "black_clip": (
        [([flat(1), flat(2)], "needs a dark, or " + THREE[6:])],
        [[dark()], [flat(1), flat(2), flat(3)]],
    ),
}
SAME = {
    "level_nonadditivity": ("reciprocity_failure",),
    "dark_current": ("hot_pixels", "amplifier_glow"),
    "saturation_knee": ("nonlinearity", "adc_inl"),
    "adc_dnl": ("stuck_bit",),
}
NAMES = [(name, like) for like in NEEDS for name in (like, *SAME.get(like, ()))]


@pytest.mark.parametrize(("name", "like"), NAMES, ids=[name for name, _ in NAMES])
def test_a_departure_names_what_is_missing(name: str, like: str) -> None:
    kind = effect_named(name)
    assert issubclass(kind, Departure)
    lacking, enough = NEEDS[like]
    for blocks, phrase in lacking:
        assert kind.why_not_testable(blocks, CAMERA) == phrase
    for blocks in enough:
        assert kind.why_not_testable(blocks, CAMERA) is None


@pytest.mark.parametrize(
    "kind", [k for k in CATALOGUE if issubclass(k, Departure)], ids=lambda kind: kind.name
)
def test_no_departure_is_lost_by_more_blocks_and_all_show_in_a_rich_plan(
    kind: type[Departure],
) -> None:
    warm = dark(20.0, temperature_c=35.0)
    rich = [dark(), warm, flat(1), flat(2), flat(1, 20.0), flat(3, 80.0), flat(1)]
    assert kind.why_not_testable(rich, CAMERA) is None
    for n in range(len(rich)):
        for some in itertools.combinations(rich, n):
            lack = kind.why_not_testable(some, CAMERA)
            assert lack is None or lack.startswith("needs ")
            if lack is None:
                assert kind.why_not_testable([*some, flat(4, 10.0)], CAMERA) is None
