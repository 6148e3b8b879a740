"""Run a plan on a bench; however it ends, the lamps are off and read back."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from calib.recording.writer import RecordingWriter
from drivers.errors import DeviceError
from drivers.ports import Cancelled, never
from service.bench.bench import Bench
from service.plan.estimate import estimate
from service.plan.expand import expand
from service.plan.model import Plan
from service.plan.step import Step
from service.sequencer.attempt import Attempt
from service.sequencer.begin import (
    camera_settings,
    check_bench,
    check_output,
    new_recording,
    resumed_recording,
)
from service.sequencer.clock import Clock, SystemClock
from service.sequencer.control import RunControl
from service.sequencer.disk import check_room
from service.sequencer.errors import RunCancelledError
from service.sequencer.events import OnColumns, OnProgress, RunResult, RunState
from service.sequencer.teller import Teller


def run_plan(
    bench: Bench,
    plan: Plan,
    out: Path,
    *,
    resume: bool = False,
    cancelled: Cancelled = never,
    control: RunControl | None = None,
    on_progress: OnProgress | None = None,
    on_columns: OnColumns | None = None,
    clock: Clock | None = None,
) -> RunResult:
    """Measure `plan` into the recording `out`; blocks until it is done, ended or failed.

    Args:
        bench: Open, and owned by the caller.
        plan: What to measure.
        out: The .h5 file; its commit record stands beside it.
        resume: Go on with `out` at the first block that is not whole.
        cancelled: Asked between frames, readings and waits; True ends the run.
        control: Pauses it, lets it go on, ends it, from other threads.
        on_progress: Told where the run stands, in the thread of the run.
        on_columns: Told each frame's column means.
        clock: Another one for tests.

    Returns:
        How it ended, `succeeded` or `cancelled`; only once the lamps are off.

    Raises:
        DarkflatError: In one sentence what went wrong. What was committed is in `out`, the lamps
            are off; a DeviceError with code `lamps-not-off` where that could not be read back.
    """
    steps = expand(plan)
    time, asked = clock or SystemClock(), control or RunControl()
    teller = Teller(on_progress, len(steps))
    try:
        with (
            _dark_afterwards(bench, teller),
            _open_recording(bench, plan, steps, out, resume=resume, clock=time) as writer,
        ):
            attempt = Attempt(
                bench,
                plan,
                steps,
                writer,
                clock=time,
                cancelled=lambda: bench.is_ending or cancelled(),
                control=asked,
                on_progress=teller.tell,
                on_columns=on_columns,
            )
            result = attempt.result(_run(attempt, teller, asked))
    except BaseException as error:
        teller.turn("failed" if isinstance(error, Exception) else "interrupted", str(error))
        raise
    teller.turn(result.state, f"{result.blocks_done} of {result.blocks_total} blocks recorded")
    return result


def _run(attempt: Attempt, teller: Teller, asked: RunControl) -> RunState:
    try:
        attempt.run()
    except RunCancelledError:
        teller.turn("aborting", "lamps off")
        return "cancelled"
    except DeviceError as error:
        if not asked.is_aborting:
            raise
        # Lamps that a safe-off put out are seen to be out before the run asks whether to end.
        teller.turn("aborting", f"lamps off; meanwhile: {error}")
        return "cancelled"
    return "succeeded"


def _open_recording(
    bench: Bench,
    plan: Plan,
    steps: Sequence[Step],
    out: Path,
    *,
    resume: bool,
    clock: Clock,
) -> RecordingWriter:
    """Check that all fits together, then begin or go on; nothing is lit yet."""
    check_output(out, resume=resume)
    check_bench(plan, bench)
    wanted = camera_settings(plan, bench, steps[0].block.exposure_us)
    used = bench.camera.configure(wanted)
    if resume:
        if bench.simulated is not None:
            bench.simulated.draw_afresh()
        return resumed_recording(plan, bench, out, used)
    check_room(out, estimate(plan, steps, columns=used.n_columns, rows=used.n_rows).n_bytes)
    return new_recording(plan, bench, out, used, clock)


@contextmanager
def _dark_afterwards(bench: Bench, teller: Teller) -> Iterator[None]:
    """Leave the lamps off and read back, whatever happens inside."""
    try:
        yield
    except BaseException as error:
        teller.turn("aborting", "lamps off")
        try:
            bench.safe_off()
        except DeviceError as lit:
            raise DeviceError(
                f"{error}; and {lit}",
                device=lit.device,
                code="lamps-not-off",
                last_exchange=lit.last_exchange,
            ) from error
        raise
    bench.safe_off()
