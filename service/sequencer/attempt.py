"""One attempt at a plan: the steps that are left, one after the other."""

from collections.abc import Sequence

from calib.recording.header import Block
from calib.recording.writer import RecordingWriter
from drivers.ports import Cancelled
from service.bench.bench import Bench
from service.plan.model import Plan
from service.plan.step import Step
from service.sequencer.begin import camera_settings
from service.sequencer.clock import Clock
from service.sequencer.columns import BrightestColumn
from service.sequencer.control import RunControl
from service.sequencer.errors import RunCancelledError, SaturationAheadError
from service.sequencer.events import OnColumns, OnProgress, Progress, RunResult, RunState
from service.sequencer.exposure import Exposure, conditions
from service.sequencer.interlocks import check_monitor, check_temperature
from service.sequencer.look_ahead import predicted_dn
from service.sequencer.pace import Pace
from service.sequencer.read_back import ReadBack
from service.sequencer.skipped import skipped_blocks, skipped_note
from service.sequencer.stand_by import StandBy
from service.sequencer.surroundings import Surroundings


class Attempt:
    """Runs what is left of `steps`; switches nothing off at its end, `run_plan` does."""

    def __init__(
        self,
        bench: Bench,
        plan: Plan,
        steps: Sequence[Step],
        writer: RecordingWriter,
        *,
        clock: Clock,
        cancelled: Cancelled,
        control: RunControl,
        on_progress: OnProgress,
        on_columns: OnColumns | None,
    ) -> None:
        self._bench = bench
        self._plan = plan
        self._steps = steps
        self._writer = writer
        self._clock = clock
        self._stand_by = StandBy(bench, plan, control, cancelled, self._turn)
        self._on_progress = on_progress
        self._state: RunState = "running"
        self._doing = "starting"
        done = {*writer.whole_blocks, *skipped_blocks(writer.notes)}
        self._pace = Pace(plan, steps, clock, [s.index for s in steps if s.block.block not in done])
        self._surroundings = Surroundings(
            bench, plan, clock=clock, cancelled=self._stand_by.breaks, say=self._say
        )
        self._exposure = Exposure(
            bench.camera,
            writer,
            cancelled=self._stand_by.breaks,
            max_lost_percent=plan.interlocks.max_lost_percent,
            on_frame=self._report,
            on_columns=on_columns,
        )
        camera = writer.header.camera
        self._limit_dn = plan.saturation.limit_percent / 100 * camera.full_scale_dn
        self._brightest = BrightestColumn(camera.full_scale_dn)
        self._origin_s = self._time_origin_s()

    def run(self) -> None:
        """Do every step that is left; raises what ends it early."""
        self._report()
        for index in tuple(self._pace.left):
            self._stand_by.until_going_on(self._surroundings)
            step = self._steps[index]
            if self._leaves_out(step):
                self._pace.leave_out(index)
                continue
            self._take_whole(step)
            self._pace.finish(index)
            self._report()
            self._surroundings.leave(step)

    def result(self, state: RunState) -> RunResult:
        """Return how it ended."""
        return RunResult(
            state=state,
            path=self._writer.path,
            blocks_done=len(self._writer.whole_blocks),
            blocks_total=len(self._steps),
            skipped=skipped_blocks(self._writer.notes),
            frames=self._exposure.counts.frames,
            lost_frames=self._exposure.counts.lost,
            notes=self._writer.notes,
            seconds=self._pace.elapsed_s,
        )

    def _take_whole(self, step: Step) -> None:
        """Take a step, and again where a pause broke it off."""
        while True:
            try:
                self._take(step)
            except RunCancelledError:
                if self._stand_by.ends:
                    raise
                if self._writer.open_block is not None:
                    self._writer.discard_block("the run was paused; it is taken again")
                self._stand_by.until_going_on(self._surroundings)
            else:
                return

    def _turn(self, state: RunState, doing: str) -> None:
        self._state = state
        self._say(doing)

    def _take(self, step: Step) -> None:
        self._surroundings.set_for(step)
        wanted = camera_settings(self._plan, self._bench, step.block.exposure_us)
        used = self._bench.camera.configure(wanted)
        before = self._checked(step, before=True)
        self._say(f"recording {step.line}")
        started_s = self._clock.monotonic() - self._origin_s
        look = self._exposure.take(step, used, before)
        after = self._checked(step, before=False)
        brightest_dn = self._brightest.of(look.mean_dn(), dark=step.capped)
        self._writer.end_block(
            conditions(step, used, before, after, started_s=started_s, brightest_dn=brightest_dn)
        )

    def _checked(self, step: Step, *, before: bool) -> ReadBack:
        """Read the bench back; raise where the run must not go on."""
        now = self._surroundings.read_back(step, before=before)
        where = f"{'before' if before else 'after'} block {step.block.block}"
        check_temperature(self._plan.interlocks, now.temperature_c, where)
        if not step.capped and step.burning > 0:
            check_monitor(self._plan.interlocks, now.monitor_a, where)
        return now

    def _leaves_out(self, step: Step) -> bool:
        """Look ahead; return True where the block is left out, raise where the run ends."""
        if step.block.kind != "flat":
            return False
        expected_dn = predicted_dn(step.block, self._taken(), limit_dn=self._limit_dn)
        if expected_dn is None or expected_dn < self._limit_dn:
            return False
        block = step.block.block
        why = f"its brightest column would reach {expected_dn:.0f} of {self._limit_dn:.0f} DN"
        match self._plan.saturation.action:
            case "note":
                self._writer.note(f"block {block} will saturate: {why}")
                return False
            case "skip":
                self._writer.note(skipped_note(block, why))
                return True
            case "stop":
                msg = f"block {block} would saturate: {why}; shorten the exposure or dim the light"
                raise SaturationAheadError(msg, code="saturation-ahead")

    def _taken(self) -> tuple[Block, ...]:
        return self._writer.header.blocks

    def _time_origin_s(self) -> float:
        """Return the monotonic time at which the recording's own time is 0.

        The wall clock may be set while lamps burn, so it counts only at the start of an attempt.
        """
        started_at = self._writer.header.camera.started_at
        ago_s = 0.0 if started_at is None else self._clock.wall() - started_at.timestamp()
        known = [b.started_s for b in self._taken() if b.started_s is not None]
        return self._clock.monotonic() - max([ago_s, 0.0, *known])

    def _say(self, doing: str) -> None:
        self._doing = doing
        self._report()

    def _report(self) -> None:
        progress = Progress(
            state=self._state,
            blocks_done=self._pace.done,
            blocks_total=len(self._steps),
            frames=self._exposure.counts.frames,
            lost_frames=self._exposure.counts.lost,
            seconds_left=self._pace.seconds_left(),
            doing=self._doing,
        )
        self._on_progress(progress)
