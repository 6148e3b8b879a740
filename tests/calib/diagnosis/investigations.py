"""Investigations on a simulated bench: how often one added sweep settles which effect it is.

    python -m tests.calib.diagnosis.investigations [runs] [case ...]

Each run hides one effect in the model of a simulated camera, opens the bench (camera, lamps,
monitor and shutter without a transport, in real time), and lets `investigate` measure. A run
counts where its first sweep left a name open; where that saw nothing, or one name alone, another
is begun. Settled is a run with one finding after two sweeps, its name the hidden one, no other
open.
"""

import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from secrets import randbits
from tempfile import TemporaryDirectory
from typing import Any

from numpy.random import Generator, default_rng

from calib.diagnosis.deciding.rivals import is_open
from calib.forward.effect import Effect
from calib.forward.effects.cti import Cti
from calib.forward.effects.dark_current import DarkCurrent
from calib.forward.effects.exposure_offset import ExposureOffset
from calib.forward.effects.gain_drift import GainDrift
from calib.forward.effects.interpixel_capacitance import InterpixelCapacitance
from calib.forward.effects.lamp_drift import LampDrift
from calib.forward.effects.offset_drift import OffsetDrift
from calib.forward.effects.stray_light import StrayLight
from service.bench import BenchSettings, open_bench
from service.bench.bench import Bench
from service.investigation.investigate import Investigation, investigate
from service.investigation.limits import bench_time
from service.plan.model import Plan
from service.sequencer.run import run_plan
from tests.calib.diagnosis.investigation_tally import Tally
from tests.calib.diagnosis.recordings import plain_model

COLUMNS, LINES, PERIOD_US = 64, 200, 1400.0
MOST_TURNS = 8
"""So many are begun at most for each that counts."""
_STEPS = (200.0, 400.0, 600.0, 800.0, 1000.0)
_AGCAM = [(t, 1) for t in _STEPS] + [(200.0, level) for level in (1, 2, 3, 4)]
_PAIRS = [pair for t in _STEPS for pair in ((t, 0), (t, 2))]
_ONE_DOSE = [(100.0, 0), (400.0, 1), (200.0, 2), (1000.0, 0), (400.0, 1), (200.0, 2)]
_FACTORIAL = [pair for t in (200.0, 600.0, 1000.0) for pair in ((t, 0), (t, 1), (t, 3))]


@dataclass(frozen=True)
class Case:
    """Two effects that the first sweep leaves open.

    Attributes:
        sweep: Exposure, us, and level of the first sweep's blocks; level 0 is a dark.
        hidden: The two.
        monitored: Whether the first sweep reads the monitor.
    """

    sweep: Sequence[tuple[float, int]]
    hidden: tuple[Effect, Effect]
    monitored: bool = True


CASES = {
    "lamp or gain drift": Case(
        _FACTORIAL, (LampDrift(0.16, 600.0), GainDrift(0.16, 600.0)), monitored=False
    ),
    "stray light or exposure offset": Case(
        _AGCAM, (StrayLight(0.004), ExposureOffset(-0.8))
    ),
    "dark current or offset drift": Case(
        _PAIRS, (DarkCurrent(0.003, 0.0), OffsetDrift(60.0, 600.0))
    ),
    # At one charge deferral has no power of the charge to show, and weak as both are here, its
    # growth along the register is seen at less than 3 sigma.
    "CTI or interpixel capacitance": Case(
        _ONE_DOSE, (Cti(per_transfer=6e-4, partition_noise=0.0), InterpixelCapacitance(0.011))
    ),
}  # fmt: skip


def first_plan(case: Case) -> Plan:
    """Return the first sweep."""
    blocks = [
        {"kind": "flat" if level else "dark", "exposure_us": t, "level": level or 1}
        for t, level in case.sweep
    ]
    return Plan.parse(
        {
            "name": "first sweep", "lines": LINES, "sweep": {"type": "listed", "blocks": blocks},
            "camera": {"line_period_us": PERIOD_US, "pixel_format": "Mono12"},
            "source": {"lamps": 4, "radiance": {"1": 1.0, "2": 2.05, "3": 3.02, "4": 4.04}},
            "lamps": {"ramp_s": 0.1, "read_back_s": 0.01},
            "settle": {
                "tolerance_percent": 5.0, "stable_for_s": 0.1, "interval_s": 0.02,
                "timeout_s": 5.0, "without_monitor_s": 0.2,
            },
        }
    )  # fmt: skip


@contextmanager
def simulated(effect: Effect, folder: Path) -> Iterator[Bench]:
    """Give a bench whose camera has `effect`."""
    plain_model(COLUMNS).with_effect(effect).save(folder / "model.toml")
    settings: dict[str, Any] = {
        "id": f"investigated-{randbits(40)}",
        "camera": {"driver": "mock"},
        "light": {"driver": "mock", "tau_s": 0.004, "ramp_s": 0.01},
        "monitor": {"driver": "mock", "integration_s": 0.005},
        "shutter": {"driver": "mock"},
        "simulation": {"model": str(folder / "model.toml"), "lamps": 4},
    }
    with open_bench(BenchSettings.parse(settings)) as bench:
        yield bench


def investigated(case: Case, effect: Effect, *, sweeps_s: float = 600.0) -> Investigation:
    """Return the investigation of a camera with `effect`."""
    plan = first_plan(case)
    with TemporaryDirectory() as name, simulated(effect, Path(name)) as bench:
        monitor = bench.monitor

        def take(each: Plan, recording: Path) -> None:
            bench.monitor = monitor if case.monitored or each is not plan else None
            run_plan(bench, each, recording)

        return investigate(take, bench_time(bench, plan), plan, Path(name), budget_s=sweeps_s)


def was_open(done: Investigation) -> bool:
    """Return whether the first sweep left a second name."""
    return any(map(is_open, done.rounds[0].diagnosis.findings))


def is_settled(done: Investigation, effect: Effect) -> bool:
    """Return whether two sweeps at most left one name open, and it is the hidden one."""
    names = [finding.effect.name for finding in done.examined.diagnosis.findings]
    return done.outcome == "decided" and len(done.rounds) <= 2 and names == [effect.name]


def hidden(case: Case, rng: Generator) -> Effect:
    """Return one of the case's two effects."""
    return case.hidden[int(rng.integers(2))]


def main() -> None:
    """Print a line per run, and a table."""
    runs = int(sys.argv[1]) if len(sys.argv) > 1 else 2
    entropy = randbits(32)
    print(f"entropy {entropy}")
    wanted = [n for n in CASES if len(sys.argv) < 3 or any(word in n for word in sys.argv[2:])]
    tallies = {name: Tally() for name in wanted}
    for run in range(MOST_TURNS * runs):
        for name in wanted:
            if tallies[name].runs == runs:
                continue
            k = list(CASES).index(name)
            effect = hidden(CASES[name], default_rng([entropy, k, run]))
            began = time.monotonic()
            done = investigated(CASES[name], effect)
            settled, left = is_settled(done, effect), was_open(done)
            tallies[name].count(done, settled=settled, was_open=left)
            print(_line(name, run, effect, done), f"{time.monotonic() - began:.0f} s", flush=True)
    print("\n| open | settled | asked for | expected, median | not open: right | nothing seen |")
    print("|---|---|---|---|---|---|")
    for name, tally in tallies.items():
        print(tally.row(name))


def _line(name: str, run: int, effect: Effect, done: Investigation) -> str:
    said = "settled" if is_settled(done, effect) else "NOT SETTLED"
    said = said if was_open(done) else "not open"
    names = [each.answer()["names"] for each in done.rounds]
    following = done.rounds[0].diagnosis.next_measurement
    why = "" if following is None else f"{following.why}, {following.expected_sigma:.1f} sigma"
    return f"{name} {run}: {effect.name} {said} {done.outcome} {names} {why}"


if __name__ == "__main__":
    main()
