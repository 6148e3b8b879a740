"""What a bench can do, and how long it takes, as the search for the deciding sweep sees it."""

from calib.diagnosis.deciding.bench import BenchTime
from service.bench.bench import Bench
from service.plan.model import Plan

DIAGNOSIS_S = 5.0
"""From the end of one sweep to the first block of the next, at least: drifts go on meanwhile."""
BLOCK_S = 0.5
"""Reading a bench back around a block: see `service.plan.estimate`."""


def bench_time(bench: Bench, plan: Plan) -> BenchTime:
    """Return the limits of `bench` where it is settled as `plan` says."""
    steady_s = plan.settle.stable_for_s if bench.monitor else plan.settle.without_monitor_s
    return BenchTime(
        line_period_us=plan.camera.line_period_us,
        settle_s=plan.lamps.ramp_s + steady_s,
        block_s=BLOCK_S + plan.lamp_count * plan.lamps.read_back_s,
        max_level=bench.light.max_level,
        has_monitor=bench.monitor is not None,
        shows_scenes=bench.target is not None,
        target_s=0.0 if bench.target is None else bench.target.takes_s,
        starts_in_s=DIAGNOSIS_S,
    )
