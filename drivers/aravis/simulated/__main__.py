"""Runs a simulated GigE Vision camera, of lines or frames, until its standard input ends.

Prints `ready` once it answers; then each line on standard input is a fault, answered with `ok`:
`lose RATIO N`, `stall N` and `die N` after N more frames (0: at once), `resume`, `afresh` (noise
that no seed repeats).
"""

import argparse
import os
import signal
import sys
import tempfile
import threading
from pathlib import Path

import numpy as np

from calib.errors import DarkflatError
from calib.forward.model import Model
from drivers.aravis.simulated.address_lock import held
from drivers.aravis.simulated.description import described
from drivers.aravis.simulated.server import Server
from drivers.mock.limits import CameraLimits
from drivers.mock.world import World

_TICK_S = 0.1


def main() -> int:
    """Run; return the exit status."""
    arguments = _arguments()
    stop = threading.Event()
    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, lambda *_: stop.set())
    try:
        _serve(arguments, stop)
    except (DarkflatError, OSError) as error:
        print(error, file=sys.stderr)  # noqa: T201
        return 1
    return 0


def _serve(arguments: argparse.Namespace, stop: threading.Event) -> None:
    model = Model.named(arguments.model)
    world = World(arguments.world)
    limits = CameraLimits(model.camera.columns, model.camera.bit_depth, model.camera.rows)
    address = held(arguments.interface, arguments.wait, arguments.lock)
    with address, tempfile.TemporaryDirectory() as folder:
        description = Path(folder) / "linescan.xml"
        description.write_text(described(limits, arguments.dialect), encoding="utf-8")
        rng = np.random.default_rng(arguments.seed)
        server = Server(
            address=arguments.interface,
            serial=arguments.serial or model.camera.serial or "SIM1",
            description=description,
            model=model,
            world=world,
            rng=rng,
        )
        print("ready", flush=True)  # noqa: T201
        if not arguments.detached:
            threading.Thread(target=_obey, args=(server, stop), daemon=True).start()
        parent = os.getppid()
        while not stop.wait(_TICK_S):
            server.tick()
            if not arguments.detached and os.getppid() != parent:
                return


def _obey(server: Server, stop: threading.Event) -> None:
    """Do what the lines on standard input say; its end ends the camera."""
    for line in sys.stdin:
        word, *rest = line.split() or [""]
        known = server.obey(word, rest)
        print("ok" if known else f"unknown command: {line.strip()}", flush=True)  # noqa: T201
    stop.set()


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m drivers.aravis.simulated", description=__doc__)
    add = parser.add_argument
    add("--model", required=True, help="a model file, or the name of a preset")
    add("--world", required=True, type=Path, help="the file of the simulated world")
    add("--serial", default="", help="the serial number that it tells; the model's where not given")
    add("--interface", default="127.0.0.1", help="an address of this machine to answer at")
    add("--seed", type=int, default=None, help="of the noise")
    add("--dialect", choices=("sfnc2", "sfnc1"), default="sfnc2", help="how it names features")
    add("--wait", type=float, default=0.0, help="seconds to wait for an address that is taken")
    add("--lock", type=int, default=None, help="descriptor of the address' lock, of the starter")
    add("--detached", action="store_true", help="outlive the starter; end by SIGTERM")
    return parser.parse_args()


if __name__ == "__main__":
    sys.exit(main())
