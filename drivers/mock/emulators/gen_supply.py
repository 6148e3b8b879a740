"""One emulated GEN supply with a tungsten lamp at its output.

Source: TDK-Lambda Genesys user manual 83-507-013, chapter 7; the lamp: drivers/mock/filament.py.
"""

from collections.abc import Callable
from dataclasses import dataclass

from drivers.mock.filament import relative_current, relative_emission, relative_voltage

_RATED_V, _RATED_A = 40.0, 38.0
_OVP_MAX_V = 44.0
_MARGIN = 1.05  # over-voltage protection stays 5 % above the voltage, the limit 5 % below
_MAINS_FAILED = 0x02


@dataclass(frozen=True)
class EmulatedLamp:
    """A lamp's rating: at `current_a` it takes `voltage_v`, and its emission is 1."""

    current_a: float = 4.0
    voltage_v: float = 24.0
    tau_s: float = 0.1
    """Time constant of its warming up, and of its cooling down."""


class GenSupply:
    """Regulates the current through its lamp; `shine(emission)` tells the world.

    Attributes:
        burnt_out: The filament is broken.
        sag: The mains give only this part of the lamp's rated voltage.
    """

    def __init__(
        self, number: int, lamp: EmulatedLamp, shine: Callable[[float, float], None]
    ) -> None:
        self.burnt_out = False
        self.sag = 1e9
        self._lamp = lamp
        self._shine = shine
        self._serial = f"{700100 + number}-EMU"
        self._faults = 0
        self._remote = "LOC"
        self._reset()

    def obey(self, command: str) -> str:
        """Return the reply to a command or query."""
        verb, _, argument = command.partition(" ")
        if verb in self._queries() and not argument:
            return self._queries()[verb]()
        if verb in ("PV", "PC", "OVP", "UVL"):
            return self._set_number(verb, argument)
        if verb in ("OUT", "RMT", "FLD"):
            return self._set_word(verb, argument)
        if command in ("RST", "CLS"):
            if command == "RST":
                self._reset()
            return "OK"
        return "C01"

    def switch(self, *, on: bool) -> str:
        """Switch the output; E07 while a fault lasts."""
        if on and self._faults:
            return "E07"
        self._on = on
        self.regulate()
        return "OK"

    def brown_out(self) -> None:
        """Let the mains fail: the output goes off, and stays off after they are back."""
        self._faults |= _MAINS_FAILED
        self._on = False
        self.regulate()

    def restore(self) -> None:
        """Bring mains and lamp back; the output stays as it is."""
        self._faults = 0
        self.burnt_out, self.sag = False, 1e9
        self.regulate()

    def regulate(self) -> None:
        """Let the lamp follow what is set."""
        emission = relative_emission(self._output()[0] / self._lamp.current_a)
        self._shine(emission, self._lamp.tau_s)

    def _reset(self) -> None:
        self._pv = self._pc = self._uvl = 0.0
        self._ovp = _OVP_MAX_V
        self._on = False
        self.regulate()

    def _output(self) -> tuple[float, float, str]:
        """Current in A, voltage in V, mode."""
        if not self._on:
            return 0.0, 0.0, "OFF"
        limit_v = min(self._pv, self.sag * self._lamp.voltage_v)
        wanted_v = self._lamp.voltage_v * relative_voltage(self._pc / self._lamp.current_a)
        if self.burnt_out:
            return 0.0, limit_v, "CV"
        if wanted_v <= limit_v:
            return self._pc, wanted_v, "CC"
        limited_a = self._lamp.current_a * relative_current(limit_v / self._lamp.voltage_v)
        return limited_a, limit_v, "CV"

    def _queries(self) -> dict[str, Callable[[], str]]:
        return {
            "IDN?": lambda: "LAMBDA,GEN40-38",
            "REV?": lambda: "1U:4.3",
            "SN?": lambda: self._serial,
            "RMT?": lambda: self._remote,
            "OUT?": lambda: "ON" if self._on else "OFF",
            "MODE?": lambda: self._output()[2],
            "PV?": lambda: _five_digits(self._pv),
            "PC?": lambda: _five_digits(self._pc),
            "MV?": lambda: _five_digits(self._output()[1]),
            "MC?": lambda: _five_digits(self._output()[0]),
            "DVC?": self._all_numbers,
            "FLT?": lambda: f"{self._faults:02X}",
            "STAT?": self._status,
        }

    def _all_numbers(self) -> str:
        current_a, voltage_v, _ = self._output()
        numbers = (voltage_v, self._pv, current_a, self._pc, self._ovp, self._uvl)
        return ",".join(_five_digits(number) for number in numbers)

    def _status(self) -> str:
        mode = self._output()[2]
        bits = (mode == "CV") | (mode == "CC") << 1 | (not self._faults) << 2
        return f"{bits | (self._faults > 0) << 3 | (self._remote == 'LOC') << 7:02X}"

    def _set_number(self, verb: str, argument: str) -> str:
        if not argument:
            return "C02"
        try:
            value = float(argument)
        except ValueError:
            return "C03"
        if error := self._number_refused(verb, value):
            return error
        setattr(self, f"_{verb.lower()}", value)
        self.regulate()
        return "OK"

    def _number_refused(self, verb: str, value: float) -> str:
        highest = {"PV": _RATED_V, "PC": _RATED_A, "OVP": _OVP_MAX_V, "UVL": _RATED_V}[verb]
        refusals = {
            "C05": not 0.0 <= value <= highest * (_MARGIN if verb[0] == "P" else 1.0),
            "E01": verb == "PV" and value * _MARGIN > self._ovp,
            "E02": verb == "PV" and value * 0.95 < self._uvl,
            "E04": verb == "OVP" and value < self._pv * _MARGIN,
            "E06": verb == "UVL" and value > self._pv * 0.95,
        }
        return next((error for error, refused in refusals.items() if refused), "")

    def _set_word(self, verb: str, argument: str) -> str:
        if not argument:
            return "C02"
        known = {"OUT": ("ON", "OFF"), "FLD": ("ON", "OFF"), "RMT": ("REM", "LOC", "LLO")}[verb]
        if argument not in known:
            return "C03"
        if verb == "RMT":
            self._remote = argument
        return self.switch(on=argument == "ON") if verb == "OUT" else "OK"


def _five_digits(number: float) -> str:
    """Five digits and a point, as the supplies write numbers below 100."""
    return f"{number:06.3f}"
