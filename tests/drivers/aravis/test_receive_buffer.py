import socket

from drivers.aravis.receive_buffer import limit_bytes, widen


def test_widens_the_socket_at_the_port_and_no_other() -> None:
    with (
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as ours,
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other,
    ):
        for each in (ours, other):
            each.bind(("127.0.0.1", 0))
            each.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        before = other.getsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF)
        assert widen(ours.getsockname()[1], 100_000)
        assert ours.getsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF) >= 100_000
        assert other.getsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF) == before


def test_says_when_there_is_no_such_socket() -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as freed:
        freed.bind(("127.0.0.1", 0))
        port = freed.getsockname()[1]
    assert not widen(port, 4096)


def test_kernel_tells_its_limit() -> None:
    limit = limit_bytes()
    assert limit is None or limit > 0
