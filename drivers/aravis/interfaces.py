"""This machine's network interfaces, for the sentence that says where a camera was looked for."""

import fcntl
import socket
import struct
from ipaddress import IPv4Address, IPv4Interface, ip_address

_SIOCGIFADDR = 0x8915
_SIOCGIFNETMASK = 0x891B


def ipv4_interfaces() -> dict[str, IPv4Interface]:
    """Return the interfaces that have an IPv4 address, by name."""
    found = {}
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        for _, name in socket.if_nameindex():
            try:
                address = _ask(probe, _SIOCGIFADDR, name)
                mask = _ask(probe, _SIOCGIFNETMASK, name)
            except OSError:  # an interface without an address carries no camera
                continue
            found[name] = IPv4Interface(f"{address}/{mask}")
    return found


def _ask(probe: socket.socket, what: int, name: str) -> IPv4Address:
    request = struct.pack("256s", name[:15].encode())
    return IPv4Address(fcntl.ioctl(probe.fileno(), what, request)[20:24])


def is_loopback(address: str) -> bool:
    """Whether `address` is a loopback IP address."""
    try:
        return ip_address(address).is_loopback
    except ValueError:
        return False


def reach_hint(address: str, interfaces: dict[str, IPv4Interface]) -> str:
    """Say what to check when no camera answers at `address`."""
    tried = ", ".join(f"{name} {net.with_prefixlen}" for name, net in interfaces.items()) or "none"
    try:
        wanted = ip_address(address)
    except ValueError:
        wanted = None
    if wanted is not None and not any(wanted in net.network for net in interfaces.values()):
        return (
            f"no interface of this machine is in its subnet (tried {tried}): give one an address "
            "there, or the camera another"
        )
    return (
        f"tried {tried}: is it powered, in the same subnet, and does the firewall let UDP port "
        "3956 and the answers pass?"
    )
