"""A service whose lamps outlive it: on supplies that nobody kills, which burn until told off."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from drivers.mock.emulators.process import EmulatorProcess
from service.bench.settings import BenchSettings
from tests.service.sequencer.benches import in_process
from tests.service.served import Served, served

PATIENT_S = 30.0
"""How long a reply may take: of a busy machine the emulators' process was given nothing for 0.8 s
at a stretch, where ten others wanted its two cores. A device has a processor of its own."""


@contextmanager
def served_with_lamps(folder: Path, *, lamps: int, baudrate: int) -> Iterator[Served]:
    """Give a service whose lamps and monitor burn and measure on without it."""
    options = ("--tau-s", "0.02", "--baudrate", str(baudrate))
    with EmulatorProcess(folder / "world", lamps=lamps, options=options) as emulators:
        content = in_process(f"server-{os.getpid()}", folder / "camera-world").model_dump()
        content["camera"]["paced"] = True  # 768 lines of 1 ms: frames come all the time
        content["light"] = {
            "driver": "gen",
            "port": emulators.ports["lamps"],
            "addresses": list(range(1, lamps + 1)),
            "baudrate": baudrate,
            "timeout_s": PATIENT_S,
            "ramp_step_a": 2.0,
            "ramp_step_s": 0.01,
        }
        content["monitor"] = {
            "driver": "keithley6485",
            "port": emulators.ports["monitor"],
            "range_a": 2e-6,
            "baudrate": baudrate,
            "timeout_s": PATIENT_S,
        }
        with served(folder, BenchSettings.parse(content)) as started:
            yield started
