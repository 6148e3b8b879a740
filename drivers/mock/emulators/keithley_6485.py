"""An emulated Keithley 6485 picoammeter with a photodiode at the sphere's wall.

Source: Keithley 6485 instruction manual; status bits of a reading: 0 overflow, 9 zero check,
10 zero correct.
"""

import time
from collections import deque
from collections.abc import Callable

import numpy as np
from numpy.random import Generator

from drivers.mock.emulators.pty_line import Reply
from drivers.mock.monitor_current import MonitorCurrent

_RANGES_A = (2e-9, 2e-8, 2e-7, 2e-6, 2e-5, 2e-4, 2e-3, 2e-2)
_OVERRANGE = 1.05
_OFFSET_A = 3e-12  # of the meter itself: what zero correct takes away
_LINE_PERIOD_S = 0.02
_ABORT = b"\x18"
_NO_ERROR = '0,"No error"'


class Keithley6485Emulator:
    """Reads the emissions of the world's lamps."""

    def __init__(
        self,
        emissions: Callable[[], tuple[float, ...]],
        rng: Generator,
        *,
        current: MonitorCurrent | None = None,
    ) -> None:
        self._emissions = emissions
        self._rng = rng
        self._current = current or MonitorCurrent()
        self._started = time.monotonic()
        self._errors: deque[str] = deque(maxlen=10)
        self._pending = b""
        self._reset()

    def receive(self, data: bytes) -> list[Reply]:
        """Commands end with LF; ^X throws away what is half said."""
        data = (
            (self._pending + data).rpartition(_ABORT)[2]
            if _ABORT in data
            else (self._pending + data)
        )
        *commands, self._pending = data.replace(b"\r", b"").split(b"\n")
        replies = [self._obey(command.decode("ascii", "replace").strip()) for command in commands]
        return [reply for reply in replies if reply is not None]

    def tick(self) -> None:
        """Nothing moves by itself."""

    def draw_afresh(self) -> None:
        """Draw noise from now on that no seed repeats."""
        self._rng = np.random.default_rng()

    def _reset(self) -> None:
        self._zero_check, self._zero_correct = True, False
        self._zero_a = self._last_a = 0.0
        self._autorange, self._range_a, self._nplc = True, _RANGES_A[-1], 5.0

    def _obey(self, command: str) -> Reply | None:
        command = command.upper().lstrip(":").removeprefix("SENS:")
        header, _, argument = command.partition(" ")
        if header.endswith("?"):
            return self._answer(header)
        if header in ("*RST", "INIT", "SYST:ZCOR:ACQ", "*CLS") and not argument:
            self._act(header)
        elif header in ("SYST:ZCH", "SYST:ZCOR", "CURR:RANG:AUTO"):
            self._switch(header, argument)
        elif header in ("CURR:RANG", "CURR:NPLC"):
            self._set_number(header, argument)
        elif header and header != "FORM:ELEM":
            self._errors.append('-113,"Undefined header"')
        return None

    def _answer(self, header: str) -> Reply | None:
        if header == "*IDN?":
            text = "KEITHLEY INSTRUMENTS INC.,MODEL 6485,1088888,B03   Sep 25 2002 12:51:19/A02  /E"
            return Reply(text.encode() + b"\n")
        if header == "SYST:ERR?":
            text = self._errors.popleft() if self._errors else _NO_ERROR
            return Reply(text.encode() + b"\n")
        if header in ("READ?", "FETC?"):
            integration_s = self._nplc * _LINE_PERIOD_S
            return Reply(self._reading(integration_s).encode() + b"\n", integration_s)
        self._errors.append('-113,"Undefined header"')
        return None

    def _act(self, header: str) -> None:
        if header == "*RST":
            self._reset()
        elif header == "*CLS":
            self._errors.clear()
        elif header == "INIT":
            self._last_a = self._measure_a(self._nplc * _LINE_PERIOD_S)
        elif self._zero_check:
            self._zero_a = self._last_a
        else:
            self._errors.append('-221,"Settings conflict"')

    def _switch(self, header: str, argument: str) -> None:
        if argument not in ("ON", "OFF", "1", "0"):
            self._errors.append('-224,"Illegal parameter value"')
            return
        on = argument in ("ON", "1")
        if header == "SYST:ZCH":
            self._zero_check = on
        elif header == "SYST:ZCOR":
            self._zero_correct = on
        else:
            self._autorange = on

    def _set_number(self, header: str, argument: str) -> None:
        try:
            value = float(argument)
        except ValueError:
            self._errors.append('-104,"Data type error"')
            return
        highest, lowest = (_RANGES_A[-1] * _OVERRANGE, 0.0) if "RANG" in header else (50.0, 0.01)
        if not lowest <= value <= highest:
            self._errors.append('-222,"Parameter data out of range"')
        elif header == "CURR:NPLC":
            self._nplc = value
        else:
            self._autorange = False
            self._range_a = next(full for full in _RANGES_A if value <= full * _OVERRANGE)

    def _measure_a(self, integration_s: float) -> float:
        lit = () if self._zero_check else self._emissions()
        measured_a = self._current.measure_a(lit, integration_s, self._rng) + _OFFSET_A
        if self._zero_check:
            measured_a -= self._current.dark_a  # the photodiode is disconnected
        return measured_a - (self._zero_a if self._zero_correct else 0.0)

    def _reading(self, integration_s: float) -> str:
        current_a = self._measure_a(integration_s)
        full_scale_a = _RANGES_A[-1] if self._autorange else self._range_a
        overflow = abs(current_a) > full_scale_a * _OVERRANGE
        status = overflow | self._zero_check << 9 | self._zero_correct << 10
        shown_a = 9.9e37 if overflow else current_a
        elapsed_s = time.monotonic() - self._started
        return f"{shown_a:+.6E}A,{elapsed_s:+.6E},{status:+.6E}"
