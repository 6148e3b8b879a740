"""A service that only begins a run, to be killed: `python -m … ID WORLD OUT`."""

import sys
import time
from pathlib import Path

from service.owner.messages import Measure, Report, Said
from service.owner.owner import BenchOwner
from service.plan.model import Plan
from tests.service.sequencer.benches import in_process, short_plan


def slow_plan() -> Plan:
    """Return a plan that takes seconds: its light has to be seen as steady for long."""
    return short_plan(settle={"tolerance_percent": 2.0, "stable_for_s": 3.0, "timeout_s": 60.0})


def tell(report: Report) -> None:
    """Print the bench's process, and that a lamp burns."""
    if isinstance(report, Said) and "steady" in report.progress.doing:
        print("lit", flush=True)  # noqa: T201


def main() -> None:
    """Begin the run, say so, and wait."""
    bench_id, world, out = sys.argv[1:4]
    owner = BenchOwner(in_process(bench_id, Path(world)), tell)
    owner.open()
    while owner.state != "idle":
        time.sleep(0.02)
    print(owner.pid, flush=True)  # noqa: T201
    owner.measure(Measure("r", slow_plan().model_dump(mode="json"), Path(out)))
    sys.stdin.read()


if __name__ == "__main__":
    main()
