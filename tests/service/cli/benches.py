"""A bench without transport and plans for it, as files."""

from pathlib import Path

from tests.service.cli.a_recording import PLAN

BENCH = """
id = "{bench_id}"
[camera]
driver = "mock"
paced = {paced}
[light]
driver = "mock"
ramp_s = 0.0
[monitor]
driver = "mock"
integration_s = 0.001
[shutter]
driver = "mock"
[simulation]
model = "demo"
seed = 3
world = "world"
"""

SETTLE = """
[settle]
tolerance_percent = 5.0
stable_for_s = 0.02
interval_s = 0.005
timeout_s = 30.0
"""


def bench_file(folder: Path, *, paced: bool = False) -> Path:
    """Write a bench of its own (locks are by id) and return its file."""
    path = folder / "bench.toml"
    bench_id = f"test-{abs(hash(str(folder)))}"
    path.write_text(BENCH.format(bench_id=bench_id, paced=str(paced).lower()))
    return path


def plan_for_bench(folder: Path, *, lines: int = 64) -> Path:
    """Write the small plan for whatever camera the bench has, and return its file."""
    path = folder / "plan.toml"
    text = PLAN.replace('serial = "D0001"\n', "").replace("lines = 64", f"lines = {lines}")
    path.write_text(text + SETTLE)
    return path
