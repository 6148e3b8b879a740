"""Packets of other programs that the stream's socket hears while it is being opened."""

import socket
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from drivers.aravis.camera import AravisCamera
from drivers.ports import CameraSettings, LostFrame

pytestmark = pytest.mark.aravis


@contextmanager
def talkative_neighbour() -> Iterator[None]:
    """Another program that sends to a port of the machine that is nobody's of ours."""
    enough = threading.Event()

    def talk() -> None:
        with (
            socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sink,
            socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as speaker,
        ):
            sink.bind(("127.0.0.1", 0))
            while not enough.is_set():
                for _ in range(20):
                    speaker.sendto(bytes(80), sink.getsockname())
                time.sleep(1e-4)

    thread = threading.Thread(target=talk)
    thread.start()
    try:
        yield
    finally:
        enough.set()
        thread.join()


def test_packets_of_another_program_are_no_frames(
    camera: AravisCamera, wanted: CameraSettings
) -> None:
    camera.configure(wanted)
    with talkative_neighbour():
        arrived = [frame for _ in range(10) for frame in camera.frames(2)]
    lost = [frame.reason for frame in arrived if isinstance(frame, LostFrame)]
    assert "cleared" not in lost
    assert len(arrived) - len(lost) == 20
