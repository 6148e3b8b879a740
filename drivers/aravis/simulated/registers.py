"""Where the simulated camera keeps what: addresses in its register space, and their units.

Those below 0x1000 are laid down by GigE Vision's bootstrap registers or by Aravis' fake camera;
ours start at 0x2000.
"""

from enum import IntEnum


class Register(IntEnum):
    """Four bytes each, big endian."""

    WIDTH = 0x100
    HEIGHT = 0x104
    GAIN_CENTIBEL = 0x110
    """In 0.01 dB; the fake camera's raw gain."""
    SENSOR_WIDTH = 0x11C
    EXPOSURE_10NS = 0x120
    ACQUISITION = 0x124
    """1 while frames are sent."""
    PIXEL_FORMAT = 0x128
    ACQUISITION_MODE = 0x12C
    OFFSET_X = 0x130
    OFFSET_Y = 0x134
    FRAME_PERIOD_US = 0x138
    """What the fake camera paces its frames by."""
    TRIGGER_MODE = 0x300
    TRIGGER_SOURCE = 0x304
    TRIGGER_ACTIVATION = 0x308
    HEARTBEAT_TIMEOUT_MS = 0x938
    PACKET_SIZE = 0xD04
    """In the low 16 bits."""
    TEMPERATURE_C = 0x2010
    """A float."""
    LINE_PERIOD_10NS = 0x2030
    """Of an area camera, from frame to frame."""
    BLACK_LEVEL_CENTIDN = 0x2050
    """In 0.01 DN of the ADC."""
    LOCKED = 0x2060
    """1 while a client holds the image format."""


VENDOR_NAME = (0x48, 32)
"""Address and length of the text."""
MODEL_NAME = (0x68, 32)
DEVICE_VERSION = (0x88, 32)
SERIAL_NUMBER = (0xD8, 16)
