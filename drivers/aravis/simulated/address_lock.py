"""One simulated camera per address: GigE Vision's control port is fixed.

Aravis' fake camera says that it runs even where it could not bind the port, so the port is tried
first; a lock on a file keeps two simulated cameras from trying at the same moment.

Why a second camera cannot simply take 127.0.0.2: all of 127.0.0.0/8 is local and would carry it,
but Aravis looks its address up in `getifaddrs`, which lists only what an interface was given, and
`lo` was given 127.0.0.1 alone. Two run side by side where an administrator gave `lo` a second one
(`ip address add 127.0.0.2/8 dev lo`), or in network namespaces of their own, which need no rights
(`unshare -rn sh -c "ip link set lo up && darkflat demo"`). Neither is ours to do unasked.
"""

import fcntl
import os
import socket
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from drivers.errors import DeviceBusyError

GVCP_PORT = 3956
_RETRY_S = 0.05


@contextmanager
def held(address: str, wait_s: float, lock: int | None = None) -> Iterator[None]:
    """Hold `address` for a simulated camera; the system lets go of it when the process dies.

    Args:
        address: An address of this machine.
        wait_s: How long to wait while somebody else holds it.
        lock: What `opened` returned to the process that started this one, where that wants to keep
            the address beyond our death; whoever has it open holds it.

    Raises:
        DeviceBusyError: Somebody else holds it after `wait_s`; code `address-taken`.
    """
    deadline_s = time.monotonic() + wait_s
    with os.fdopen(opened(address) if lock is None else lock, "r+") as file:
        while not (_locked(file.fileno()) and _port_free(address)):
            if time.monotonic() >= deadline_s:
                raise DeviceBusyError(
                    f"{address}: UDP port {GVCP_PORT} is taken by another simulated camera or "
                    "GigE Vision program; wait for its end, or give another address that an "
                    "interface has (`ip address add 127.0.0.2/8 dev lo` makes one)",
                    device=address,
                    code="address-taken",
                )
            time.sleep(_RETRY_S)
        yield


def opened(address: str) -> int:
    """Open the file whose lock stands for `address`, and return its descriptor."""
    path = Path(tempfile.gettempdir()) / f"darkflat-gige-vision-{address}-{_network()}.lock"
    flags = os.O_RDWR | os.O_CLOEXEC | os.O_NOFOLLOW
    try:
        # Without O_CREAT: in a shared folder the system refuses it for other users' files.
        return os.open(path, flags)
    except FileNotFoundError:
        descriptor = os.open(path, flags | os.O_CREAT, 0o666)
        os.fchmod(descriptor, 0o666)
        return descriptor


def _network() -> int:
    """Return what tells network namespaces apart: each has addresses of its own."""
    return Path("/proc/self/ns/net").stat().st_ino


def _locked(descriptor: int) -> bool:
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True


def _port_free(address: str) -> bool:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.bind((address, GVCP_PORT))
        except OSError:
            return False
    return True
