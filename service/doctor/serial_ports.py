"""Serial ports, pseudo-terminals, and the right to use them."""

import getpass
import os
from pathlib import Path

from service.doctor.finding import Finding

_PATTERNS = ("ttyUSB*", "ttyACM*")


def look_at_serial(dev: Path = Path("/dev")) -> list[Finding]:
    """Return what was found about serial ports under `dev`."""
    return [_ports(dev), _pseudo_terminals()]


def _ports(dev: Path) -> Finding:
    ports = sorted(port for pattern in _PATTERNS for port in dev.glob(pattern))
    if not ports:
        return Finding("serial ports", "ok", "no USB serial adapter is plugged in")
    names = ", ".join(port.name for port in ports)
    closed = [port.name for port in ports if not os.access(port, os.R_OK | os.W_OK)]
    if closed:
        remedy = f"sudo usermod -aG dialout {_user()}   # then log in again"
        text = f"no right to use {', '.join(closed)} of {names}"
        return Finding("serial ports", "missing", text, remedy)
    return Finding("serial ports", "ok", names)


def _pseudo_terminals() -> Finding:
    try:
        for descriptor in os.openpty():
            os.close(descriptor)
    except OSError as error:
        text = f"none can be opened ({error.strerror}): no simulated lamps"
        return Finding("pseudo-terminals", "advice", text, "mount -t devpts devpts /dev/pts")
    return Finding("pseudo-terminals", "ok", "can be opened: simulated lamps work")


def _user() -> str:
    try:
        return getpass.getuser()
    except (KeyError, OSError):
        return "$USER"
