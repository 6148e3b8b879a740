import numpy as np
import pytest

from drivers.aravis.unpack import unpacked
from drivers.pixel_formats import FORMATS
from drivers.ports import PixelFormat

WIRE: list[tuple[PixelFormat, str, list[int]]] = [
    ("Mono8", "01 ff 80 00", [0x01, 0xFF, 0x80, 0x00]),
    ("Mono10", "ff 03 01 00 00 02 34 01", [0x3FF, 1, 0x200, 0x134]),
    ("Mono12", "bc 0a ff 0f 01 00 00 08", [0xABC, 0xFFF, 1, 0x800]),
    ("Mono14", "ff 3f 01 00 00 20 cd 2b", [0x3FFF, 1, 0x2000, 0x2BCD]),
    ("Mono16", "cd ab ff ff 01 00 00 80", [0xABCD, 0xFFFF, 1, 0x8000]),
    ("Mono12Packed", "ab fc de 00 21 00", [0xABC, 0xDEF, 0x001, 0x002]),
    ("Mono12p", "bc fa de 01 20 00", [0xABC, 0xDEF, 0x001, 0x002]),
]


@pytest.mark.parametrize(("name", "wire", "dn"), WIRE, ids=[name for name, _, _ in WIRE])
def test_bytes_become_codes(name: PixelFormat, wire: str, dn: list[int]) -> None:
    raw = np.frombuffer(bytes.fromhex(wire), np.uint8)
    image = unpacked(raw, FORMATS[name], 2, 2)
    assert image.tolist() == [dn[:2], dn[2:]]
    assert image.dtype == (np.uint8 if name == "Mono8" else np.uint16)
    assert image.flags.owndata or image.base is not raw
    assert not np.shares_memory(image, raw)


def test_both_packed_formats_differ_in_the_same_bytes() -> None:
    raw = np.frombuffer(bytes.fromhex("abfcde"), np.uint8)
    as_packed = unpacked(raw, FORMATS["Mono12Packed"], 1, 2)
    as_p = unpacked(raw, FORMATS["Mono12p"], 1, 2)
    assert as_packed.tolist() == [[0xABC, 0xDEF]]
    assert as_p.tolist() == [[0xCAB, 0xDEF]]


def test_big_endian_cameras_are_read_as_such() -> None:
    raw = np.frombuffer(bytes.fromhex("0abc 0fff"), np.uint8)
    assert unpacked(raw, FORMATS["Mono12"], 1, 2, "big").tolist() == [[0xABC, 0xFFF]]
    assert unpacked(raw, FORMATS["Mono12"], 1, 2, "little").tolist() == [[0xBC0A, 0xFF0F]]


@pytest.mark.parametrize("name", list(FORMATS))
def test_a_byte_too_few_is_an_error_and_a_byte_too_many_is_padding(name: PixelFormat) -> None:
    needed = FORMATS[name].n_bytes(3 * 5)
    with pytest.raises(ValueError, match=name):
        unpacked(np.zeros(needed - 1, np.uint8), FORMATS[name], 3, 5)
    assert unpacked(np.zeros(needed + 1, np.uint8), FORMATS[name], 3, 5).shape == (3, 5)


def test_codes_are_those_of_the_naming_convention() -> None:
    assert {name: code.bits_on_the_wire for name, code in FORMATS.items()} == {
        "Mono8": 8, "Mono10": 16, "Mono12": 16, "Mono12Packed": 12, "Mono12p": 12,
        "Mono14": 16, "Mono16": 16,
    }  # fmt: skip
