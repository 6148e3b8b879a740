"""Tells a light to go off of which nothing is known yet but its line. Imports next to nothing.

For the first moment of a start: the light may burn on from a program that was killed, and to find
its devices one by one takes seconds. Nothing is read back, and what answers is left to whoever
opens the line next, who begins by discarding it.
"""

from contextlib import closing

from drivers.serial.port import PortSettings, SerialPort


def gen_off(port: str, *, baudrate: int = 9600) -> None:
    """Send the group command, which every GEN supply on the line obeys.

    Raises DeviceNotFoundError, DeviceBusyError where somebody holds it, or DeviceTimeoutError.
    """
    _send(PortSettings(port, "lamps", baudrate), b"\rGOUT OFF\r")


def mightex_off(port: str, *, channel: int = 1, baudrate: int = 9600) -> None:
    """Disable the channel; raises as `gen_off` does."""
    _send(PortSettings(port, "led", baudrate), b"\n\rMODE %d 0\n\r" % channel)


def _send(settings: PortSettings, command: bytes) -> None:
    """Send `command`, which begins with the end of what a dead program left half sent."""
    with closing(SerialPort(settings)) as line:
        line.write(command)
