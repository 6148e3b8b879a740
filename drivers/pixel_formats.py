"""Monochrome pixel formats: their codes, bits, and how many bytes a frame of them takes.

Source: GenICam Pixel Format Naming Convention (PFNC), 32-bit values; Mono12Packed is
GigE Vision 1.x, older than the convention.
"""

from dataclasses import dataclass

from drivers.ports import PixelFormat


@dataclass(frozen=True)
class FormatCode:
    """One format.

    Attributes:
        name: As GenICam's `PixelFormat` spells it.
        pfnc: The code that travels in the leader of each frame.
        bits: Of each pixel's value.
    """

    name: PixelFormat
    pfnc: int
    bits: int

    @property
    def bits_on_the_wire(self) -> int:
        """Bits that a pixel takes, padding included: bits 16 to 23 of the code."""
        return (self.pfnc >> 16) & 0xFF

    def n_bytes(self, n_pixels: int) -> int:
        """Return how many bytes `n_pixels` take, the last one filled up."""
        return (n_pixels * self.bits_on_the_wire + 7) // 8


FORMATS: dict[PixelFormat, FormatCode] = {
    code.name: code
    for code in (
        FormatCode("Mono8", 0x01080001, 8),
        FormatCode("Mono10", 0x01100003, 10),
        FormatCode("Mono12", 0x01100005, 12),
        FormatCode("Mono12Packed", 0x010C0006, 12),
        FormatCode("Mono12p", 0x010C0047, 12),
        FormatCode("Mono14", 0x01100025, 14),
        FormatCode("Mono16", 0x01100007, 16),
    )
}

PACKED = tuple(name for name, code in FORMATS.items() if code.bits_on_the_wire % 8)
"""Formats that share bytes between pixels."""

BY_PFNC: dict[int, FormatCode] = {code.pfnc: code for code in FORMATS.values()}


def smallest_for(bit_depth: int) -> PixelFormat:
    """Return the smallest unpacked format that carries `bit_depth` bits."""
    unpacked = (code for code in FORMATS.values() if code.name not in PACKED)
    return next(code.name for code in unpacked if code.bits >= bit_depth)
