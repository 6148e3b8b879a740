"""Network: what GigE Vision needs to lose no packet."""

from pathlib import Path

from service.doctor.finding import Finding

_JUMBO_MTU = 9000
_ENOUGH_BYTES = 16 << 20
_ETHERNET = "1"  # /sys/class/net/<interface>/type


def look_at_network(
    interfaces: Path = Path("/sys/class/net"),
    rmem_max: Path = Path("/proc/sys/net/core/rmem_max"),
) -> list[Finding]:
    """Return what was found about packet sizes and socket buffers."""
    return [*_packet_sizes(interfaces), _socket_buffer(rmem_max)]


def _packet_sizes(interfaces: Path) -> list[Finding]:
    found = []
    for interface in sorted(interfaces.glob("*")):
        # Only hardware: a bridge or a tunnel has no camera behind it.
        if not (interface / "device").exists() or _read(interface / "type") != _ETHERNET:
            continue
        mtu = int(_read(interface / "mtu") or 0)
        name = f"network {interface.name}"
        if mtu < _JUMBO_MTU:
            text = f"packets of {mtu} bytes: six times as many as with jumbo frames"
            remedy = f"sudo ip link set {interface.name} mtu {_JUMBO_MTU}"
            found.append(Finding(name, "advice", text, remedy))
        else:
            found.append(Finding(name, "ok", f"packets of {mtu} bytes"))
    return found


def _socket_buffer(rmem_max: Path) -> Finding:
    limit = int(_read(rmem_max) or 0)
    if limit < _ENOUGH_BYTES:
        text = f"at most {limit / 1e6:.2g} MB: GigE Vision loses packets when this machine is busy"
        remedy = f"sudo sysctl -w net.core.rmem_max={_ENOUGH_BYTES}"
        return Finding("socket buffer", "advice", text, remedy)
    return Finding("socket buffer", "ok", f"up to {limit / 1e6:.2g} MB")


def _read(path: Path) -> str:
    try:
        return path.read_text(encoding="ascii").strip()
    except OSError:
        return ""
