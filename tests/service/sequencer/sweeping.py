"""A sweep in a process of its own, so that it can be killed: `python -m … BENCH PLAN OUT`."""

import signal
import sys
from pathlib import Path

from service.bench import open_bench
from service.plan.model import Plan
from service.sequencer.run import run_plan


def main() -> None:
    """Begin the recording, or go on with it where it is there already."""
    # A shell's background job ignores Ctrl-C, and so would this; a person's terminal does not.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    bench_file, plan_file, out = (Path(argument) for argument in sys.argv[1:4])
    with open_bench(bench_file) as bench:
        run_plan(bench, Plan.load(plan_file), out, resume=out.exists())


if __name__ == "__main__":
    main()
