"""An in-process bench that moves fast, and a plan that is short."""

from pathlib import Path
from typing import Any

from calib.recording.file_recording import FileRecording
from drivers.mock.world import World
from service.bench import BenchSettings
from service.plan.model import Plan

SETTLES = {"tolerance_percent": 2.0, "stable_for_s": 0.05, "interval_s": 0.01, "timeout_s": 5.0}


def in_process(
    bench_id: str, world: Path | None = None, *, lamps: int = 3, model: str = "demo"
) -> BenchSettings:
    """Return the settings of a bench without any transport, with a name of its own."""
    return BenchSettings.parse(
        {
            "id": f"test-{bench_id}",
            "camera": {"driver": "mock", "paced": False},
            "light": {"driver": "mock", "tau_s": 0.01, "ramp_s": 0.004},
            "monitor": {"driver": "mock", "integration_s": 0.002},
            "shutter": {"driver": "mock"},
            "simulation": {"model": model, "lamps": lamps, "world": world},
        }
    )


def short_plan(**changes: Any) -> Plan:
    """Return a plan of four blocks of four frames: dark, flat, dark, flat."""
    return Plan.parse(
        {
            "sweep": {"type": "exposure", "exposures_us": [50.0, 100.0], "level": 1},
            "camera": {"line_period_us": 1000.0, "columns": 32},
            "lines": 32,
            "frame_lines": 8,
            "settle": SETTLES,
            **changes,
        }
    )


def assert_dark(world: World) -> None:
    """Fail where a lamp burns, or is on its way to."""
    assert [lamp.target for lamp in world.state().lamps] == [0.0] * len(world.state().lamps)


def whole_blocks(out: Path) -> dict[str, int]:
    """Read every frame, its CRC verified, and return the lines of each whole block."""
    recording = FileRecording(out)
    return {
        block.block: sum(len(dn) for dn in recording.frames(block.block))
        for block in recording.header.blocks
    }
