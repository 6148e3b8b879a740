"""The bench that stands in where no bench file is named."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from service.bench.settings import BenchSettings
from service.doctor.aravis import why_no_aravis
from service.settings import Settings

MODEL = "demo"
LAMPS = 4
"""Reading each back over its slow line before and after every block takes most of the time."""


@dataclass(frozen=True)
class ChosenBench:
    """A bench, and why it is this one; `remark` is empty where a file named it."""

    settings: BenchSettings
    remark: str = ""


def simulated_bench(*, seed: int | None = None) -> ChosenBench:
    """Return a simulated bench: GigE Vision on loopback, or in this process without Aravis.

    The controllers are emulators on pseudo-terminals either way.
    """
    missing = why_no_aravis()
    camera: dict[str, Any] = {"driver": "mock"} if missing else {"driver": "aravis"}
    content = {
        "id": "simulated",
        "camera": camera,
        "light": {"driver": "gen", "ramp_step_a": 2.0, "ramp_step_s": 0.05},
        "monitor": {"driver": "keithley6485"},
        "shutter": {"driver": "rly16"},
        "simulation": {"model": MODEL, "lamps": LAMPS, "seed": seed, "warm_up_s": 0.1},
    }
    remark = "simulated bench"
    if missing:
        remark += f"; its camera without GigE Vision: {missing}"
    return ChosenBench(BenchSettings.parse(content), remark)


def chosen_bench(named: Path | None) -> ChosenBench:
    """Return the bench that `--bench`, DARKFLAT_BENCH or ./bench.toml names, or a simulated one."""
    beside = Path("bench.toml")
    path = named or Settings.load().bench or (beside if beside.is_file() else None)
    if path is None:
        chosen = simulated_bench()
        remark = f"no bench file (--bench): {chosen.remark}"
        return ChosenBench(chosen.settings, remark)
    return ChosenBench(BenchSettings.load(path))
