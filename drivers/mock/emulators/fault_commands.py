"""Faults by a line of text: what the process with the emulators reads on its standard input."""

from collections.abc import Callable

from drivers.mock.emulators.bench import EmulatedBench
from drivers.mock.emulators.keithley_6485 import Keithley6485Emulator
from drivers.mock.emulators.mightex_slc import MightexSlc
from drivers.mock.emulators.pty_line import PtyLine
from drivers.mock.emulators.rly16 import Rly16

LANGUAGE = """\
LINE is lamps, led, monitor or shutter; LAMP counts from 1.
  LINE garble N        the next N replies come garbled
  LINE truncate N      the next N replies come without their second half
  LINE delay S N       the next N replies come S seconds late
  LINE silent on|off   everything is obeyed, nothing answered
  LINE deaf on|off     nothing is heard
  LINE vanish          the port disappears; LINE return brings it back
  LINE mend            takes back all of these but vanish
  lamp LAMP brown-out  its mains fail, and its output goes off
  lamp LAMP sag F      its mains give only the fraction F of its rated voltage
  lamp LAMP burn-out   its filament breaks
  lamp LAMP restore    mains and filament are back, the output stays as it is
  led brown-out        the controller restarts
  shutter stick on|off the relays do not move
  monitor afresh       its noise is from now on such as no seed repeats
"""


def inject(bench: EmulatedBench, text: str) -> None:
    """Do what `text` says; ValueError where it says nothing known."""
    try:
        subject, *words = text.split()
        if subject == "lamp":
            _lamp_faults(bench, int(words[0]))[words[1]](*map(float, words[2:]))
        else:
            line = bench.lines[subject]
            (_line_faults(line) | _device_faults(line))[words[0]](*words[1:])
    except (KeyError, IndexError, TypeError, ValueError) as error:
        raise ValueError(f"{text!r} is no fault of this bench. {LANGUAGE}") from error


def _lamp_faults(bench: EmulatedBench, lamp: int) -> dict[str, Callable[..., None]]:
    supply = bench.supplies[lamp]

    def sag(fraction: float) -> None:
        supply.sag = fraction
        supply.regulate()

    def burn_out() -> None:
        supply.burnt_out = True
        supply.regulate()

    return {
        "brown-out": supply.brown_out,
        "restore": supply.restore,
        "sag": sag,
        "burn-out": burn_out,
    }


def _line_faults(line: PtyLine) -> dict[str, Callable[..., None]]:
    faults = line.faults

    def delay(seconds: str, count: str) -> None:
        faults.delay_s, faults.delay = float(seconds), int(count)

    return {
        "garble": lambda count: setattr(faults, "garble", int(count)),
        "truncate": lambda count: setattr(faults, "truncate", int(count)),
        "delay": delay,
        "silent": lambda on: setattr(faults, "silent", _on(on)),
        "deaf": lambda on: setattr(faults, "deaf", _on(on)),
        "vanish": line.vanish,
        "return": line.come_back,
        "mend": faults.clear,
    }


def _device_faults(line: PtyLine) -> dict[str, Callable[..., None]]:
    device = line.device
    if isinstance(device, MightexSlc):
        return {"brown-out": device.brown_out}
    if isinstance(device, Keithley6485Emulator):
        return {"afresh": device.draw_afresh}
    if isinstance(device, Rly16):
        return {"stick": lambda on: setattr(device, "stuck", _on(on))}
    return {}


def _on(word: str) -> bool:
    return {"on": True, "off": False}[word]
