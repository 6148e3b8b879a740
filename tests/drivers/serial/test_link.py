"""The link survives what serial lines do: each line of the table is one thing that was seen."""

import os
import re
import threading
import time
import tty
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from drivers.errors import (
    DeviceBusyError,
    DeviceError,
    DeviceLostError,
    DeviceNotFoundError,
    DeviceTimeoutError,
    ProtocolError,
)
from drivers.serial.link import SerialLink
from drivers.serial.port import PortSettings
from drivers.serial.sync import Sync
from tests.drivers.serial.far_end import FarEnd, Script

_SYNC = Sync(b"WHO?\r", re.compile(rb"(?<![^\r\n])me(?=[\r\n])"), clear=b"\r")


def _reply(text: bytes, wait_s: float = 0.0) -> Script:
    return lambda command: [(wait_s, text)] if command else []


@pytest.fixture
def connect(tmp_path: Path) -> Iterator[Callable[[Script], tuple[SerialLink, FarEnd]]]:
    links: list[SerialLink] = []
    far_ends: list[FarEnd] = []

    def connected(script: Script) -> tuple[SerialLink, FarEnd]:
        far = FarEnd(tmp_path / "port", script)
        settings = PortSettings(str(far.path), "thing", 115200, write_timeout_s=5.0)
        link = SerialLink(settings, end="\r", timeout_s=5.0, sync=_SYNC)
        links.append(link)
        far_ends.append(far)
        return link, far

    yield connected
    for link in links:
        link.close()
    for far in far_ends:
        far.unplug()


Connect = Callable[[Script], tuple[SerialLink, FarEnd]]

_SOON_S = 0.1
"""A time-out where nothing comes; where something does, a busy machine may take its time."""


def _is_waiting(link: SerialLink) -> bool:
    """Return once something that nobody asked for has arrived."""
    until = time.monotonic() + 30
    while not link.port.has_input() and time.monotonic() < until:
        time.sleep(0.005)
    return link.port.has_input()


@pytest.mark.parametrize("end", [b"\r", b"\n", b"\r\n", b"\n\r", b"\r\r\n", b"\n\n"], ids=repr)
def test_any_mix_of_cr_and_lf_ends_a_reply(connect: Connect, end: bytes) -> None:
    link, _ = connect(lambda command: [(0.0, command.lower() + end)] if command else [])
    assert [link.query(f"ASK{i}") for i in range(3)] == ["ask0", "ask1", "ask2"]


def test_echo_is_not_taken_for_the_reply(connect: Connect) -> None:
    link, _ = connect(lambda command: [(0.0, command + b"\r42\r")] if command else [])
    assert link.query("ASK") == "42"


def test_what_arrived_unasked_is_not_taken_for_the_reply(connect: Connect) -> None:
    link, far = connect(_reply(b"right\r"))
    assert link.query("ASK") == "right"
    os.write(far.master, b"unasked\r")
    assert _is_waiting(link)
    assert link.query("ASK") == "right"


def test_deadline_holds_for_the_whole_reply_not_per_byte(connect: Connect) -> None:
    link, _ = connect(lambda command: [(0.06, b"x")] * 20 if command == b"ASK" else [])
    link.synchronise(_SYNC)
    with pytest.raises(DeviceTimeoutError) as caught:
        link.query("ASK", timeout_s=0.25)
    # At 60 ms a byte, a time-out per byte of 250 ms would have read all of them.
    assert caught.value.last_exchange.count("x") < 20


def test_late_reply_is_not_read_as_the_answer_to_the_next_question(connect: Connect) -> None:
    def answer(command: bytes) -> list[tuple[float, bytes]]:
        if command == b"FIRST":
            far.wait_for(b"WHO?", times=2)  # its time is over, and the link gets into step anew
        return [(0.0, command.lower() + b"\r")] if command else []

    link, far = connect(answer)
    link.synchronise(_SYNC)
    with pytest.raises(DeviceTimeoutError):
        link.query("FIRST", timeout_s=_SOON_S)
    assert not link.in_step
    assert link.query("SECOND") == "second"
    assert link.query("THIRD") == "third"


def test_late_answers_to_the_same_question_do_not_stay_behind(connect: Connect) -> None:
    # The answer to the first WHO? comes when a second one was asked: two "me" are on their way.
    def answer_late(_: bytes) -> list[tuple[float, bytes]]:
        far.wait_for(b"WHO?", times=2)
        return [(0.0, b"me\r")]

    link, far = connect(_reply(b"ok\r"))
    far.answers_who = answer_late
    link.timeout_s = _SOON_S
    with pytest.raises(DeviceTimeoutError):
        link.query("ASK")
    link.timeout_s = 5.0
    assert link.query("ASK") == "ok"
    assert link.query("ASK") == "ok"


def test_silence_is_a_time_out_that_shows_what_was_sent(connect: Connect) -> None:
    link, _ = connect(lambda command: [])
    link.synchronise(_SYNC)
    with pytest.raises(DeviceTimeoutError) as caught:
        link.query("ASK", timeout_s=_SOON_S)
    assert caught.value.code == "device-timeout"
    assert "ASK" in caught.value.last_exchange
    assert "thing" in caught.value.device


def test_reply_without_its_end_is_a_time_out_that_shows_it(connect: Connect) -> None:
    link, _ = connect(_reply(b"+1.04"))
    link.synchronise(_SYNC)
    with pytest.raises(DeviceTimeoutError) as caught:
        link.query("ASK", timeout_s=1.0)
    assert "+1.04" in caught.value.last_exchange


def test_garbled_reply_is_a_protocol_error_and_the_next_one_is_good(connect: Connect) -> None:
    replies = iter([b"+1\x00.\xb04\r", b"+1.04\r"])
    link, _ = connect(lambda command: [(0.0, next(replies))] if command else [])
    with pytest.raises(ProtocolError) as caught:
        link.query("ASK")
    assert caught.value.code == "reply-garbled"
    assert "\\xb0" in caught.value.last_exchange
    assert link.query("ASK") == "+1.04"


def test_unplugged_while_waiting_is_lost(connect: Connect) -> None:
    link, far = connect(lambda command: [(0.05, b"x")] * 3 if command == b"ASK" else [])
    link.synchronise(_SYNC)
    unplugging = threading.Timer(0.1, far.unplug)
    unplugging.start()
    with pytest.raises(DeviceLostError) as caught:
        link.query("ASK", timeout_s=5.0)
    assert caught.value.code == "device-lost"
    unplugging.join()


def test_unplugged_between_questions_is_lost_and_stays_lost(connect: Connect) -> None:
    link, far = connect(_reply(b"ok\r"))
    link.query("ASK")
    far.unplug()
    for _ in range(3):
        with pytest.raises(DeviceLostError):
            link.query("ASK")
        with pytest.raises(DeviceLostError):
            link.send("DO")


def test_plugged_in_again_goes_on_in_step(connect: Connect) -> None:
    link, far = connect(_reply(b"ok\r"))
    link.query("ASK")
    far.unplug()
    with pytest.raises(DeviceLostError):
        link.query("ASK")
    far.plug()
    assert link.query("ASK") == "ok"
    assert b"WHO?" in far.heard[-3:]


def test_another_device_behind_the_same_path_is_not_talked_to(connect: Connect) -> None:
    link, far = connect(_reply(b"ok\r"))
    link.query("ASK")
    far.unplug()
    with pytest.raises(DeviceLostError):
        link.query("ASK")
    far.answers_who = _reply(b"stranger\r")
    far.plug()
    heard = len(far.heard)
    link.timeout_s = 1.0
    with pytest.raises(DeviceTimeoutError):
        link.query("ASK")
    assert b"ASK" not in far.heard[heard:]


def test_device_that_takes_no_bytes_is_a_time_out() -> None:
    master, slave = os.openpty()
    tty.setraw(slave)
    link = SerialLink(
        PortSettings(os.ttyname(slave), "thing", 115200, write_timeout_s=0.1), end="\r"
    )
    try:
        with pytest.raises(DeviceTimeoutError, match="does not take"):
            link.send("x" * 100_000)
    finally:
        link.close()
        os.close(master)
        os.close(slave)


def test_second_owner_is_refused_and_the_first_goes_on(connect: Connect) -> None:
    link, far = connect(_reply(b"ok\r"))
    with pytest.raises(DeviceBusyError) as caught:
        SerialLink(PortSettings(str(far.path), "thing", 115200), end="\r")
    assert caught.value.code == "device-busy"
    assert link.query("ASK") == "ok"


def test_port_is_free_again_after_close(connect: Connect) -> None:
    link, far = connect(_reply(b"ok\r"))
    link.close()
    SerialLink(PortSettings(str(far.path), "thing", 115200), end="\r").close()


@pytest.mark.parametrize(
    ("name", "kind"), [("no-such-port", DeviceNotFoundError), ("a-file", DeviceError)]
)
def test_what_is_no_port_is_refused(tmp_path: Path, name: str, kind: type[DeviceError]) -> None:
    (tmp_path / "a-file").write_text("")
    with pytest.raises(kind, match=name):
        SerialLink(PortSettings(str(tmp_path / name), "thing", 9600), end="\r")


def test_closed_link_says_so(connect: Connect) -> None:
    link, _ = connect(_reply(b"ok\r"))
    link.close()
    with pytest.raises(DeviceError) as caught:
        link.query("ASK")
    assert caught.value.code == "device-closed"


def test_interjection_goes_out_while_another_thread_waits(connect: Connect) -> None:
    # The far end answers the question only once it has heard the interjection.
    link, far = connect(lambda command: [(0.0, b"heard\r")] if command == b"OFF" else [])
    replies: list[str] = []
    link.synchronise(_SYNC)
    thread = threading.Thread(target=lambda: replies.append(link.query("ASK", timeout_s=30.0)))
    thread.start()
    far.wait_for(b"ASK")
    link.interject("OFF")
    thread.join(30)
    assert replies == ["heard"]


def test_bytes_are_answered_by_count(connect: Connect) -> None:
    link, _ = connect(lambda command: [(0.02, b"\x09"), (0.02, b"\xff")] if command else [])
    assert link.query_bytes(b"Z\r", 2) == b"\x09\xff"
    link.timeout_s = 0.3
    with pytest.raises(DeviceTimeoutError):
        link.query_bytes(b"Z\r", 3)


def test_a_late_answer_beside_the_right_one_is_not_taken_for_it(connect: Connect) -> None:
    replies = iter([b"\x01\x02", b"\x02", b"\x03"])
    link, far = connect(lambda command: [(0.0, next(replies))] if command == b"Z" else [])
    with pytest.raises(ProtocolError) as caught:
        link.query_bytes(b"Z\r", 1)
    assert caught.value.code == "reply-garbled"
    assert not link.in_step
    assert link.query_bytes(b"Z\r", 1) == b"\x02"
    assert far.heard[-2:] == [b"WHO?", b"Z"]
    assert link.query_bytes(b"Z\r", 1) == b"\x03"
    assert far.heard[-2:] == [b"Z", b"Z"]


def test_bytes_that_came_after_the_reply_put_the_link_out_of_step(connect: Connect) -> None:
    link, far = connect(_reply(b"\x02"))
    assert link.query_bytes(b"Z\r", 1) == b"\x02"
    os.write(far.master, b"\x01")
    assert _is_waiting(link)
    assert link.query_bytes(b"Z\r", 1) == b"\x02"
    assert far.heard[-2:] == [b"WHO?", b"Z"]
