"""The emulators speak as the controllers' documents say, at the line's speed."""

import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
import serial

from drivers.mock.emulators.bench import BenchSettings, EmulatedBench
from drivers.mock.emulators.fault_commands import inject
from drivers.mock.emulators.gen_chain import GenChain
from drivers.mock.emulators.gen_supply import EmulatedLamp, GenSupply
from drivers.mock.emulators.keithley_6485 import Keithley6485Emulator
from drivers.mock.emulators.line_faults import LineFaults
from drivers.mock.emulators.mightex_slc import MightexSlc
from drivers.mock.emulators.pty_line import EmulatedDevice, PtyLine, Reply
from drivers.mock.emulators.rly16 import Rly16
from drivers.mock.world import World


def _dark(_emission: float, _tau_s: float) -> None:
    """Light nothing."""


def _said(device: EmulatedDevice, data: bytes) -> bytes:
    return b"".join(reply.data for reply in device.receive(data))


@pytest.fixture
def chain() -> GenChain:
    supplies = {number: GenSupply(number, EmulatedLamp(), _dark) for number in (1, 2)}
    return GenChain(supplies, address_settle_s=0.0)


GEN_DIALOGUES = {
    "nobody is addressed at first": (b"IDN?\r", b""),
    "addressed": (b"ADR 1\rIDN?\r", b"OK\rLAMBDA,GEN40-38\r"),
    "absent unit is silent, and nobody is addressed": (b"ADR 1\rADR 7\rIDN?\r", b"OK\r"),
    "line feeds are ignored": (b"ADR 1\r\nOUT?\r\n", b"OK\rOFF\r"),
    "bare CR": (b"ADR 1\r\r", b"OK\rOK\r"),
    "repeat": (b"ADR 1\rMODE?\r\\\r", b"OK\rOFF\rOFF\r"),
    "lower case": (b"adr 1\rout?\r", b"OK\rOFF\r"),
    "set and read": (b"ADR 1\rPV 26\rPV?\r", b"OK\rOK\r26.000\r"),
    "group off answers nothing": (b"ADR 1\rGOUT OFF\rOUT?\r", b"OK\rOFF\r"),
    "illegal": (b"ADR 1\rHELLO\r", b"OK\rC01\r"),
    "parameter missing": (b"ADR 1\rPC\r", b"OK\rC02\r"),
    "parameter bad": (b"ADR 1\rPC x\r", b"OK\rC03\r"),
    "out of range": (b"ADR 1\rPC 99\r", b"OK\rC05\r"),
    "voltage above protection": (b"ADR 1\rOVP 20\rPV 26\r", b"OK\rOK\rE01\r"),
    "protection below voltage": (b"ADR 1\rPV 26\rOVP 20\r", b"OK\rOK\rE04\r"),
    "limit above voltage": (b"ADR 1\rPV 26\rUVL 26\r", b"OK\rOK\rE06\r"),
    "voltage below limit": (b"ADR 1\rPV 26\rUVL 20\rPV 10\r", b"OK\rOK\rOK\rE02\r"),
    "status off": (b"ADR 1\rRMT REM\rSTAT?\rFLT?\r", b"OK\rOK\r04\r00\r"),
    "status at constant current": (
        b"ADR 1\rRMT REM\rPV 26\rPC 4\rOUT ON\rSTAT?\rMODE?\r",
        b"OK\rOK\rOK\rOK\rOK\r06\rCC\r",
    ),
    "reset": (b"ADR 1\rPV 26\rRST\rPV?\r", b"OK\rOK\rOK\r00.000\r"),
}


@pytest.mark.parametrize("dialogue", GEN_DIALOGUES)
def test_gen_supplies_answer_as_documented(chain: GenChain, dialogue: str) -> None:
    asked, answered = GEN_DIALOGUES[dialogue]
    assert _said(chain, asked) == answered


def test_gen_command_in_pieces_is_one_command(chain: GenChain) -> None:
    assert [_said(chain, piece) for piece in (b"AD", b"R 1", b"\r")] == [b"", b"", b"OK\r"]


def test_gen_supply_loses_what_comes_before_it_listens() -> None:
    now_s = 0.0
    supplies = {1: GenSupply(1, EmulatedLamp(), _dark)}
    chain = GenChain(supplies, address_settle_s=0.1, clock=lambda: now_s)
    assert _said(chain, b"ADR 1\rIDN?\r") == b"OK\r"
    now_s += 0.09
    assert _said(chain, b"IDN?\r") == b""
    now_s += 0.02
    assert _said(chain, b"IDN?\r") == b"LAMBDA,GEN40-38\r"


def test_gen_group_off_reaches_every_supply(chain: GenChain) -> None:
    for address in (b"1", b"2"):
        _said(chain, b"ADR " + address + b"\rPV 26\rPC 4\rOUT ON\r")
    _said(chain, b"GOUT OFF\r")
    assert [supply.obey("OUT?") for supply in chain.supplies.values()] == ["OFF", "OFF"]


def _sag(supply: GenSupply) -> None:
    supply.sag = 0.9


def _break(supply: GenSupply) -> None:
    supply.burnt_out = True


LAMP_STATES: dict[str, tuple[Callable[[GenSupply], None], str, float, float]] = {
    # what happens: mode, current, emission
    "nominal": (lambda supply: None, "CC", 4.0, 1.0),
    "sag to 90 %": (_sag, "CV", 4.0 * 0.9 ** (1 / 1.9), 0.9 ** (6.5 / 1.9)),
    "broken": (_break, "CV", 0.0, 0.0),
    "mains failed": (GenSupply.brown_out, "OFF", 0.0, 0.0),
}


@pytest.mark.parametrize("state", LAMP_STATES)
def test_lamp_follows_what_its_supply_gives(state: str) -> None:
    happens, mode, current_a, emission = LAMP_STATES[state]
    emissions: list[float] = []
    supply = GenSupply(1, EmulatedLamp(), lambda e, _: emissions.append(e))
    for command in ("PV 26", "PC 4", "OUT ON"):
        supply.obey(command)
    happens(supply)
    supply.regulate()
    assert supply.obey("MODE?") == mode
    assert float(supply.obey("MC?")) == pytest.approx(current_a, abs=0.0005)
    assert emissions[-1] == pytest.approx(emission)


MIGHTEX_DIALOGUES = {
    "unknown": (b"HELLO 1\n\r", b"HELLO is not defined\n\r"),
    "channel 5 of 4": (b"MODE 5 1\n\r", b"#?\n\r"),
    "above the ceiling": (b"NORMAL 1 1001 10\n\r", b"#?\n\r"),
    "set above its own ceiling": (b"NORMAL 1 100 200\n\r", b"#?\n\r"),
    "set and read": (
        b"NORMAL 1 500 200\n\rMODE 1 1\n\r?MODE 1\n\rLoadVoltage 1\n\r",
        b"##\n\r##\n\r#1\n\r#1:2900\n\r",
    ),
}


@pytest.mark.parametrize("dialogue", MIGHTEX_DIALOGUES)
def test_mightex_answers_as_documented(dialogue: str) -> None:
    asked, answered = MIGHTEX_DIALOGUES[dialogue]
    device = MightexSlc(_dark)
    device.receive(b"ECHOOFF\n\r")
    assert _said(device, asked) == answered


def test_mightex_echoes_until_told_not_to() -> None:
    device = MightexSlc(_dark)
    assert _said(device, b"?MODE 1\n\r") == b"?MODE 1\n\r#0\n\r"
    device.receive(b"ECHOOFF\n\r")
    assert _said(device, b"?MODE 1\n\r") == b"#0\n\r"
    device.brown_out()
    assert _said(device, b"?MODE 1\n\r") == b"?MODE 1\n\r#0\n\r"


KEITHLEY_DIALOGUES = {
    "no error": (b"SYST:ERR?\n", b'0,"No error"\n'),
    "unknown": (b"HELLO\nSYST:ERR?\nSYST:ERR?\n", b'-113,"Undefined header"\n0,"No error"\n'),
    "range": (b"CURR:RANG 1\nSYST:ERR?\n", b'-222,"Parameter data out of range"\n'),
    "no number": (b"SENS:CURR:NPLC x\nSYST:ERR?\n", b'-104,"Data type error"\n'),
    "zero without check": (
        b"SYST:ZCH OFF\nSYST:ZCOR:ACQ\nSYST:ERR?\n",
        b'-221,"Settings conflict"\n',
    ),
    "abort": (b"*ID\x18SYST:ERR?\n", b'0,"No error"\n'),
}


@pytest.mark.parametrize("dialogue", KEITHLEY_DIALOGUES)
def test_keithley_answers_as_documented(dialogue: str) -> None:
    asked, answered = KEITHLEY_DIALOGUES[dialogue]
    device = Keithley6485Emulator(lambda: (1.0,), np.random.default_rng(1))
    assert _said(device, asked) == answered


def test_keithley_reads_nothing_while_zero_check_is_on() -> None:
    device = Keithley6485Emulator(lambda: (1.0,), np.random.default_rng(1))
    checked, _, status = _said(device, b"READ?\n").decode().split(",")
    assert abs(float(checked.rstrip("A"))) < 1e-10
    assert int(float(status)) & 1 << 9
    lit = _said(device, b"SYST:ZCH OFF\nREAD?\n").decode()
    assert float(lit.split("A")[0]) == pytest.approx(2e-7, rel=1e-3)


def test_keithley_takes_its_integration_time() -> None:
    device = Keithley6485Emulator(lambda: (1.0,), np.random.default_rng(1))
    (reply,) = device.receive(b"SENS:CURR:NPLC 10\nREAD?\n")
    assert reply.after_s == pytest.approx(0.2)


def test_relay_board_moves_the_cap_after_its_travel(tmp_path: Path) -> None:
    world = World.create(tmp_path / "world", 1)
    travel_s = 0.5
    board = Rly16(world, travel_s=travel_s)
    began = time.monotonic()
    assert _said(board, b"\x65\x5b") == b"\x01"
    on_its_way = world.state().capped
    if time.monotonic() - began < travel_s:  # else this machine slept through it
        assert not on_its_way
    time.sleep(travel_s)
    assert world.state().capped


@pytest.mark.parametrize(
    ("sent", "states"),
    [(b"\x64", 0xFF), (b"\x64\x6e", 0), (b"\x5c\x5a", 0x5A), (b"\x66\x6c\x70", 0x80)],
    ids=["all on", "all off", "set", "single"],
)
def test_relay_board_sets_its_relays(sent: bytes, states: int, tmp_path: Path) -> None:
    world = World.create(tmp_path / "world", 1)
    assert _said(Rly16(world), sent + b"\x5b") == bytes([states])


def test_spoilt_replies_are_counted() -> None:
    faults = LineFaults(garble=1, truncate=1, delay=1, delay_s=0.5)
    assert faults.spoil(b"12.5\r") == (b"\xb12", 0.5)
    assert faults.spoil(b"12.5\r") == (b"12.5\r", 0.0)


class Parrot:
    """Says 100 characters to every byte."""

    def receive(self, data: bytes) -> list[Reply]:
        return [Reply(b"x" * 100)] * len(data)

    def tick(self) -> None:
        """Nothing moves."""


@pytest.fixture
def parrot(tmp_path: Path) -> Iterator[PtyLine]:
    line = PtyLine(tmp_path / "port", Parrot(), baudrate=9600)
    yield line
    line.close()


def test_line_is_no_faster_than_its_baud_rate(parrot: PtyLine) -> None:
    with serial.Serial(str(parrot.path), 9600, timeout=5) as port:
        started = time.monotonic()
        port.write(b"a")
        assert port.read(100) == b"x" * 100
        # 101 characters of 10 bits; that it is no faster is its promise, not how fast it is.
        assert time.monotonic() - started >= 101 * 10 / 9600


def test_line_outlives_its_clients(parrot: PtyLine) -> None:
    for _ in range(3):
        with serial.Serial(str(parrot.path), 9600, timeout=5, exclusive=True) as port:
            port.write(b"a")
            assert port.read(100) == b"x" * 100


def test_line_that_vanished_comes_back_at_the_same_path(parrot: PtyLine) -> None:
    parrot.vanish()
    assert not parrot.path.exists()
    parrot.come_back()
    with serial.Serial(str(parrot.path), 9600, timeout=5) as port:
        port.write(b"a")
        assert port.read(100) == b"x" * 100


def test_client_that_never_reads_does_not_stop_the_line(parrot: PtyLine) -> None:
    with serial.Serial(str(parrot.path), 9600, timeout=5) as port:
        for _ in range(60):
            port.write(b"a" * 100)
    parrot.vanish()  # done by the line's own thread: it still runs


@pytest.mark.parametrize(
    "fault",
    [
        "",
        "lamps",
        "lamps explode",
        "lamp 9 brown-out",
        "lamp 1 sag",
        "led garble 1",
        "lamps garble x",
    ],
)
def test_fault_that_is_none_is_refused(tmp_path: Path, fault: str) -> None:
    world = World.create(tmp_path / "world", 1)
    with (
        EmulatedBench(world, tmp_path / "ports", BenchSettings(lamps=1)) as bench,
        pytest.raises(ValueError, match="no fault"),
    ):
        inject(bench, fault)


def test_world_with_too_few_lamps_is_refused(tmp_path: Path) -> None:
    world = World.create(tmp_path / "world", 1)
    with pytest.raises(ValueError, match="a world with 3 lamps"):
        EmulatedBench(world, tmp_path / "ports", BenchSettings(lamps=2, led=True))
