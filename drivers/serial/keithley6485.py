"""The monitor: a Keithley 6485 picoammeter with a photodiode at the sphere's wall.

Source: Keithley 6485 instruction manual, sections 2 (zero check and zero correct) and 13 (SCPI).
"""

import re
import time

from drivers.errors import DeviceError, SettingRefusedError
from drivers.ports import DeviceIdentity, MonitorReading
from drivers.serial.link import SerialLink
from drivers.serial.port import PortSettings
from drivers.serial.sync import Sync

_READING = re.compile(
    r"(?P<current>[+-]\d\.\d{6}E[+-]\d\d)A,[+-]\d\.\d{6}E[+-]\d\d,(?P<status>[+-]\d\.\d{6}E[+-]\d\d)"
)
_NO_READING_A = 9.9e37  # overflow; 9.91e37 is not a number
_ZERO_CHECK_BIT = 9
_SYNC = Sync(
    question=b"*IDN?\n",
    answer=re.compile(rb"(?<![^\r\n])KEITHLEY INSTRUMENTS[^\r\n]+(?=[\r\n])"),
    clear=b"\x18\n",  # ^X aborts what it is doing
)
RANGES_A = (2e-9, 2e-8, 2e-7, 2e-6, 2e-5, 2e-4, 2e-3, 2e-2)
"""Full scales."""


class Keithley6485:
    """Measures on demand; zero-corrected when opened."""

    def __init__(self, link: SerialLink, *, line_period_s: float, nplc: float) -> None:
        """Prefer `open`."""
        self._link = link
        self._reading_s = nplc * line_period_s
        self._identity = self._who()

    @classmethod
    def open(
        cls,
        port: str,
        *,
        range_a: float | None = None,
        nplc: float = 1.0,
        mains_hz: float = 50.0,
        baudrate: int = 9600,
        timeout_s: float = 1.0,
        name: str = "monitor",
    ) -> "Keithley6485":
        """Reset the meter, correct its zero, and set its range.

        Args:
            port: The port's path.
            range_a: The smallest of `RANGES_A` that holds this; None leaves it to the meter.
            nplc: Integration time in periods of the mains, 0.01 ... 50 (60 at 60 Hz).
            mains_hz: The mains' frequency.
            baudrate: Bits per second.
            timeout_s: How long a reply may take beyond the integration.
            name: What the bench file calls it.

        Raises DeviceNotFoundError, DeviceBusyError, DeviceTimeoutError, ProtocolError, or
        SettingRefusedError where the meter takes a setting amiss.
        """
        settings = PortSettings(port, name, baudrate)
        link = SerialLink(settings, end="\n", timeout_s=timeout_s, sync=_SYNC)
        try:
            meter = cls(link, line_period_s=1.0 / mains_hz, nplc=nplc)
            meter.correct_zero()
            meter.configure(range_a, nplc)
        except BaseException:
            link.close()
            raise
        return meter

    @property
    def identity(self) -> DeviceIdentity:
        """The meter's."""
        return self._identity

    def correct_zero(self) -> None:
        """Reset; measure the meter's own offset, its input shorted, and subtract it from now on."""
        self._set("*RST", "SYST:ZCH ON", "CURR:RANG 2e-9", "INIT")
        time.sleep(self._reading_s)
        self._set("SYST:ZCOR:ACQ", "SYST:ZCOR ON", "SYST:ZCH OFF")

    def configure(self, range_a: float | None, nplc: float) -> None:
        """Set range and integration; SettingRefusedError where the meter has no such."""
        if range_a is None:
            chosen = "CURR:RANG:AUTO ON"
        else:
            chosen = f"CURR:RANG {self._range_for(range_a):.0e}"
        self._set(chosen, f"SENS:CURR:NPLC {nplc:g}", "FORM:ELEM READ,UNIT,TIME,STAT")

    def read(self) -> MonitorReading:
        """Measure once.

        Raises DeviceError with code `monitor-overflow` when out of range, and `monitor-zero-check`
        when the meter's input is shorted (it was reset, or somebody pressed the key).
        """
        with self._link.lock:
            reply = self._link.query("READ?", timeout_s=self._link.timeout_s + 2 * self._reading_s)
            now_ns = time.time_ns()
            match = _READING.fullmatch(reply)
            if match is None:
                raise self._link.protocol_error(f"{reply!r} is no reading")
        current_a = float(match["current"])
        if abs(current_a) >= _NO_READING_A:
            raise self._unusable("out of range; choose a higher range", "monitor-overflow")
        if int(float(match["status"])) >> _ZERO_CHECK_BIT & 1:
            raise self._unusable("zero check is on; open the monitor anew", "monitor-zero-check")
        return MonitorReading(current_a, now_ns)

    def close(self) -> None:
        """Release the line; safe to call twice."""
        self._link.close()

    def _who(self) -> DeviceIdentity:
        reply = self._link.query("*IDN?")
        parts = reply.split(",")
        if len(parts) != 4 or not parts[1].startswith("MODEL 648"):
            raise self._link.protocol_error(f"{reply!r} is not how a Keithley 6485 names itself")
        vendor, model, serial, firmware = parts
        address = self._link.port.settings.address
        return DeviceIdentity(vendor, model.removeprefix("MODEL "), serial, firmware, address)

    def _set(self, *commands: str) -> None:
        """Send settings, which nothing answers; then ask whether they were taken."""
        with self._link.lock:
            for command in commands:
                self._link.send(command)
            reply = self._link.query("SYST:ERR?", timeout_s=self._link.timeout_s + self._reading_s)
        if not re.match(r"[+-]?0,", reply):
            raise SettingRefusedError(
                f"{self._link.device} says {reply} to {'; '.join(commands)}",
                device=self._link.device,
                code="setting-refused",
                last_exchange=self._link.port.last_exchange,
            )

    def _range_for(self, current_a: float) -> float:
        fitting = [full_scale for full_scale in RANGES_A if full_scale >= abs(current_a)]
        if not fitting:
            raise SettingRefusedError(
                f"{self._link.device}: no range holds {current_a:g} A; the highest is 0.02 A",
                device=self._link.device,
                code="setting-refused",
            )
        return fitting[0]

    def _unusable(self, text: str, code: str) -> DeviceError:
        return DeviceError(
            f"{self._link.device}: {text}",
            device=self._link.device,
            code=code,
            last_exchange=self._link.port.last_exchange,
        )
