"""The GEN protocol: several power supplies on one line, addressed one at a time.

Source: TDK-Lambda Genesys user manual 83-507-013, chapter 7 (RS232 and RS485 remote control).
"""

import re
import time
from dataclasses import dataclass
from types import MappingProxyType

from drivers.errors import DeviceNotFoundError, DeviceTimeoutError, SettingRefusedError
from drivers.serial.link import SerialLink
from drivers.serial.sync import Sync, whole_line

_NUMBER = re.compile(r"\d+\.\d+")
_REFUSAL = re.compile(r"[CE]\d\d")
_ANY_SUPPLY = re.compile(rb"(?<![^\r\n])[^\r\n]*LAMBDA,[^\r\n]+(?=[\r\n])")
_GROUP_SETTLE_S = 0.2

REFUSALS = MappingProxyType(
    {
        "E01": "voltage above what the over-voltage protection allows",
        "E02": "voltage below the under-voltage limit",
        "E04": "over-voltage protection below the voltage",
        "E06": "under-voltage limit above the voltage",
        "E07": "switched on during a fault",
        "C01": "not a command",
        "C02": "parameter missing",
        "C03": "parameter not understood",
        "C04": "wrong checksum",
        "C05": "out of range",
    }
)
FAULTS = (
    "spare",
    "mains failed",
    "too hot",
    "foldback",
    "over-voltage",
    "shut off at the rear",
    "switched off at the front",
    "enable open",
)
"""The bits of `FLT?`, lowest first."""


@dataclass(frozen=True)
class Unit:
    """One supply and the lamp that it feeds; lamps count from 1."""

    lamp: int
    address: int
    model: str
    serial: str


@dataclass(frozen=True)
class UnitReading:
    """One supply, read back.

    Attributes:
        output_on: Whether its output is switched on.
        mode: CC (constant current), CV (constant voltage) or OFF.
        current_a, voltage_v: Measured at its output.
        faults: The names of the faults that it reports.
    """

    output_on: bool
    mode: str
    current_a: float
    voltage_v: float
    faults: tuple[str, ...]


class GenUnits:
    """Talks to supplies in turn; hold `link.lock` around exchanges that belong together."""

    def __init__(self, link: SerialLink, *, address_settle_s: float = 0.1) -> None:
        self.link = link
        self._settle_s = address_settle_s
        self._addressed: int | None = None

    def name(self, unit: Unit) -> str:
        """Return which lamp, and where its supply is, for messages."""
        return f"lamp {unit.lamp} (supply {unit.address}, {self.link.device})"

    def find(self, lamp: int, address: int) -> Unit:
        """Ask the supply at `address` who it is; DeviceNotFoundError where nothing answers."""
        try:
            model = self._greet(address)
        except DeviceTimeoutError as error:
            raise DeviceNotFoundError(
                f"{self.link.device}: no supply answers at address {address} (lamp {lamp}); "
                "is it switched on, set to remote, and is its baud rate right?",
                device=self.link.device,
                code="device-not-found",
                last_exchange=error.last_exchange,
            ) from error
        return Unit(lamp, address, model, self.link.query("SN?"))

    def ask(self, unit: Unit, query: str) -> str:
        """Return the reply of `unit` to `query`; SettingRefusedError when it refuses."""
        with self.link.lock:
            self._address(unit)
            reply = self.link.query(query)
            if _REFUSAL.fullmatch(reply):
                raise SettingRefusedError(
                    f"{self.name(unit)} refuses {query!r}: {REFUSALS.get(reply, reply)}",
                    device=self.link.device,
                    code="setting-refused",
                    last_exchange=self.link.port.last_exchange,
                )
            return reply

    def tell(self, unit: Unit, command: str) -> None:
        """Have `unit` do `command`."""
        with self.link.lock:
            if (reply := self.ask(unit, command)) != "OK":
                raise self.link.protocol_error(f"{reply!r} instead of OK to {command!r}")

    def number(self, unit: Unit, query: str) -> float:
        """Return the number that `unit` answers to `query`."""
        with self.link.lock:
            reply = self.ask(unit, query)
            if not _NUMBER.fullmatch(reply):
                raise self.link.protocol_error(f"{reply!r} is no number, in answer to {query!r}")
            return float(reply)

    def output_on(self, unit: Unit) -> bool:
        """Whether the output of `unit` is switched on."""
        return self._choice(unit, "OUT?", ("ON", "OFF")) == "ON"

    def read(self, unit: Unit) -> UnitReading:
        """Read `unit` back."""
        with self.link.lock:
            return UnitReading(
                output_on=(on := self.output_on(unit)),
                mode=self._choice(unit, "MODE?", ("CC", "CV", "OFF")) if on else "OFF",
                current_a=self.number(unit, "MC?"),
                voltage_v=self.number(unit, "MV?"),
                faults=self._faults(unit),
            )

    def all_off(self) -> None:
        """Send the group command that every supply obeys and none answers; wait for it."""
        with self.link.lock:
            self.link.send("GOUT OFF")
            time.sleep(_GROUP_SETTLE_S)

    def _choice(self, unit: Unit, query: str, known: tuple[str, ...]) -> str:
        reply = self.ask(unit, query)
        if reply not in known:
            raise self.link.protocol_error(f"{reply!r} in answer to {query!r}")
        return reply

    def _faults(self, unit: Unit) -> tuple[str, ...]:
        reply = self.ask(unit, "FLT?")
        if not re.fullmatch(r"[0-9A-Fa-f]{2}", reply):
            raise self.link.protocol_error(f"{reply!r} in answer to 'FLT?'")
        bits = int(reply, 16)
        return tuple(name for bit, name in enumerate(FAULTS) if bits >> bit & 1)

    def _greet(self, address: int) -> str:
        """Address a supply that is not known yet; return how it names itself."""
        if not self.link.ready():
            self.link.synchronise(self._sync(address, "IDN?", _ANY_SUPPLY))
            self._addressed = address
        self._select(address)
        model = self.link.query("IDN?")
        if "LAMBDA," not in model:
            raise self.link.protocol_error(f"{model!r} is not how a GEN supply names itself")
        return model

    def _address(self, unit: Unit) -> None:
        """Have `unit` listen, whatever the line went through since the last question."""
        if not self.link.ready():
            self._addressed = None
            self.link.synchronise(self._sync(unit.address, "SN?", whole_line(unit.serial)))
            self._addressed = unit.address
        self._select(unit.address)

    def _select(self, address: int) -> None:
        if self._addressed == address:
            return
        self._addressed = None
        if (reply := self.link.query(f"ADR {address}")) != "OK":
            raise self.link.protocol_error(f"{reply!r} instead of OK to its address")
        time.sleep(self._settle_s)
        self._addressed = address

    def _sync(self, address: int, question: str, answer: re.Pattern[bytes]) -> Sync:
        return Sync(
            question=f"{question}\r".encode(),
            answer=answer,
            clear=b"\r",
            preamble=f"ADR {address}\r".encode(),
            preamble_answer=whole_line("OK"),
            preamble_s=self._settle_s,
        )
