"""An emulated Mightex SLC-SA04 LED controller with one LED on channel 1."""

import re
from collections.abc import Callable

from drivers.mock.emulators.pty_line import Reply

_CHANNELS = range(1, 5)
_CEILING_MA = 1000
_FORWARD_V = 2.9
_FIXED_ANSWERS = {
    "DEVICEINFO": "Mightex LED Driver:3.1.8 Device Module No.:SLC-SA04-U/S "
    "Device Serial No.:04-081010-002",
    "STORE": "##",
    "RESET": "##",
    "RESTOREDEF": "##",
}
_N_ARGUMENTS = {
    "NORMAL": 3,
    "CURRENT": 2,
    "MODE": 2,
    "?MODE": 1,
    "?CURRENT": 1,
    "LoadVoltage": 1,
}


class MightexSlc:
    """Four channels; channel 1 lights the world, linearly in its current.

    It echoes what it hears until told ECHOOFF, and again after a brown-out.
    """

    def __init__(
        self,
        shine: Callable[[float, float], None],
        *,
        nominal_current_ma: float = 500.0,
        tau_s: float = 0.02,
    ) -> None:
        self._shine = shine
        self._nominal_ma = nominal_current_ma
        self._tau_s = tau_s
        self._pending = b""
        self.brown_out()

    def brown_out(self) -> None:
        """Restart: every channel is off, and the echo on."""
        self._echo = True
        self._mode = dict.fromkeys(_CHANNELS, 0)
        self._max_ma = dict.fromkeys(_CHANNELS, 20)
        self._set_ma = dict.fromkeys(_CHANNELS, 10)
        self._drive()

    def receive(self, data: bytes) -> list[Reply]:
        """Commands end with LF CR."""
        replies = [Reply(data)] if self._echo else []
        *commands, self._pending = re.split(rb"[\r\n]+", self._pending + data)
        answers = [
            self._obey(command.decode("ascii", "replace")) for command in commands if command
        ]
        return [
            *replies,
            *(Reply(answer.encode("ascii") + b"\n\r") for answer in answers if answer),
        ]

    def tick(self) -> None:
        """Nothing moves by itself."""

    def _obey(self, command: str) -> str:
        if command == "ECHOOFF":
            self._echo = False
            return ""
        if command in _FIXED_ANSWERS:
            return _FIXED_ANSWERS[command]
        verb, *arguments = command.split() or [""]
        if verb not in _N_ARGUMENTS:
            return f"{verb} is not defined"
        if len(arguments) != _N_ARGUMENTS[verb] or not all(a.isdigit() for a in arguments):
            return "#?"
        channel, *numbers = map(int, arguments)
        if channel not in _CHANNELS:
            return "#?"
        return self._set(verb, channel, numbers) if numbers else self._tell(verb, channel)

    def _set(self, verb: str, channel: int, numbers: list[int]) -> str:
        if verb == "MODE":
            if numbers[0] not in range(4):
                return "#?"
            self._mode[channel] = numbers[0]
        else:
            ceiling = numbers[0] if verb == "NORMAL" else self._max_ma[channel]
            if ceiling > _CEILING_MA or numbers[-1] > ceiling:
                return "#?"
            self._max_ma[channel], self._set_ma[channel] = ceiling, numbers[-1]
        self._drive()
        return "##"

    def _tell(self, verb: str, channel: int) -> str:
        if verb == "?MODE":
            return f"#{self._mode[channel]}"
        if verb == "?CURRENT":
            return f"#50 0 0 {self._max_ma[channel]} {self._set_ma[channel]}"
        lit = channel == 1 and self._mode[1] == 1
        return f"#{channel}:{round(1000 * _FORWARD_V) if lit else 0}"

    def _drive(self) -> None:
        current_ma = self._set_ma[1] if self._mode[1] == 1 else 0
        self._shine(current_ma / self._nominal_ma, self._tau_s)
