"""All emulators in one process: `python -m drivers.mock.emulators --world W --lamps 6`.

Prints one line of JSON with the ports, then serves until it is terminated or its parent has died.
With `--control` it reads faults, one a line, on its standard input, and answers each with a line of
JSON; the end of that input then ends it too.
"""

import argparse
import json
import os
import select
import signal
import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import Event
from types import FrameType

from drivers.mock.emulators.bench import BenchSettings, EmulatedBench
from drivers.mock.emulators.fault_commands import LANGUAGE, inject
from drivers.mock.emulators.gen_supply import EmulatedLamp
from drivers.mock.monitor_current import MonitorCurrent
from drivers.mock.world import World

_WATCH_S = 0.2


def main() -> None:
    """Serve until told to stop."""
    arguments = _arguments()
    parent, stopping = os.getppid(), Event()

    def stop(_number: int, _frame: FrameType | None) -> None:
        stopping.set()

    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, stop)
    settings = _settings(arguments)
    with TemporaryDirectory(prefix="darkflat-ports-") as folder:
        world = _world(arguments.world, settings.lamps + settings.led)
        with EmulatedBench(world, arguments.ports or Path(folder), settings) as bench:
            _say(bench.ports)
            while not stopping.is_set() and os.getppid() == parent:
                if not arguments.control:
                    stopping.wait(_WATCH_S)
                elif select.select([sys.stdin], [], [], _WATCH_S)[0]:
                    if not (line := sys.stdin.readline()):
                        break
                    _obey(bench, line)


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="python -m drivers.mock.emulators",
        description=__doc__,
        epilog=LANGUAGE,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    defaults = BenchSettings()
    add = parser.add_argument
    add("--world", type=Path, required=True, help="the shared world; made when it is not there")
    add("--lamps", type=int, default=defaults.lamps, help="how many; 0 for none")
    add("--led", action="store_true", help="add an LED")
    add("--ports", type=Path, help="folder for the ports; a temporary one when not given")
    add("--baudrate", type=int, default=defaults.baudrate)
    add("--address-settle-s", type=float, default=defaults.address_settle_s)
    add("--lamp-current-a", type=float, default=defaults.lamp.current_a, help="nominal")
    add("--lamp-voltage-v", type=float, default=defaults.lamp.voltage_v, help="nominal")
    add("--tau-s", type=float, default=defaults.lamp.tau_s, help="of a lamp's warming up")
    add("--amperes-per-lamp", type=float, default=defaults.current.amperes_per_lamp)
    add("--travel-s", type=float, default=defaults.travel_s, help="of the shutter")
    add("--seed", type=int, default=defaults.seed, help="of the monitor's noise")
    add("--control", action="store_true", help="read faults on standard input")
    return parser.parse_args()


def _settings(arguments: argparse.Namespace) -> BenchSettings:
    return BenchSettings(
        lamps=arguments.lamps,
        led=arguments.led,
        lamp=EmulatedLamp(arguments.lamp_current_a, arguments.lamp_voltage_v, arguments.tau_s),
        current=MonitorCurrent(amperes_per_lamp=arguments.amperes_per_lamp),
        baudrate=arguments.baudrate,
        address_settle_s=arguments.address_settle_s,
        travel_s=arguments.travel_s,
        seed=arguments.seed,
    )


def _world(path: Path, n_lamps: int) -> World:
    return World(path) if path.exists() else World.create(path, n_lamps)


def _obey(bench: EmulatedBench, line: str) -> None:
    try:
        inject(bench, line.strip())
    except ValueError as error:
        _say({"error": str(error)})
    else:
        _say({"done": line.strip()})


def _say(answer: object) -> None:
    sys.stdout.write(json.dumps(answer) + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    main()
