"""A sweep in a process of its own, so that it can be killed: `python -m … BENCH PLAN OUT`."""

import signal
import sys
import time
from pathlib import Path

from service.bench import open_bench
from service.plan.model import Plan
from service.sequencer.events import Progress
from service.sequencer.run import run_plan

NEVER_ENDING = "--never-ending"
"""Wait within the last block for ever: whoever kills this cannot come too late."""


def main() -> int:
    """Begin the recording, or go on with it where it is there already; 0 where it is whole."""
    # A shell's background job ignores Ctrl-C, and so would this; a person's terminal does not.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    bench_file, plan_file, out = (Path(argument) for argument in sys.argv[1:4])
    listener = wait_in_the_last_block if NEVER_ENDING in sys.argv else None
    with open_bench(bench_file) as bench:
        plan = Plan.load(plan_file)
        result = run_plan(bench, plan, out, resume=out.exists(), on_progress=listener)
    return 0 if result.state == "succeeded" else 1


def wait_in_the_last_block(progress: Progress) -> None:
    """Wait as soon as its first frame is there, or it is about to be asked for."""
    is_last = progress.blocks_done == progress.blocks_total - 1
    while is_last and progress.state == "running" and progress.doing.startswith("recording"):
        time.sleep(0.1)


if __name__ == "__main__":
    sys.exit(main())
