"""Benches whose controllers are emulators on pseudo-terminals; the camera is in the process."""

import os
from pathlib import Path
from typing import Any

from service.bench import BenchSettings
from service.plan.model import Plan
from tests.service.sequencer.benches import short_plan

GEN = {"driver": "gen", "ramp_step_a": 2.0, "ramp_step_s": 0.01}
MIGHTEX = {"driver": "mightex"}


def on_lines(
    name: str, light: dict[str, Any], world: Path | None = None, *, lamps: int = 2
) -> BenchSettings:
    """Return a bench with `light`, a picoammeter and a relay on quick lines."""
    return BenchSettings.parse(
        {
            "id": f"lines-{os.getpid()}-{name}",
            "camera": {"driver": "mock", "paced": False},
            "light": light,
            "monitor": {"driver": "keithley6485", "range_a": 2e-6},
            "shutter": {"driver": "rly16"},
            "simulation": {
                "model": "demo",
                "lamps": lamps,
                "warm_up_s": 0.02,
                "baudrate": 115200,
                "world": world,
            },
        }
    )


def line_plan(**changes: Any) -> Plan:
    """Return a short plan that does not wait long for slow lines."""
    settle = {"tolerance_percent": 5.0, "stable_for_s": 0.1, "interval_s": 0.02, "timeout_s": 20.0}
    return short_plan(settle=settle, **changes)
