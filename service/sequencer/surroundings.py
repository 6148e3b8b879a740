"""What burns, whether the lens is capped, and since when the light is steady."""

from collections.abc import Callable

from drivers.errors import DeviceError
from drivers.ports import Cancelled, LightState
from service.bench.bench import Bench
from service.plan.model import Plan
from service.plan.step import Step
from service.sequencer.burning import check_burning
from service.sequencer.clock import Clock, wait
from service.sequencer.errors import RunCancelledError
from service.sequencer.read_back import ReadBack, read_back
from service.sequencer.settle import wait_until_steady


class Surroundings:
    """Sets what a step asks for; changes nothing that already is so.

    Nothing is believed of the time before: the first level is always set, and always settles.
    """

    def __init__(
        self,
        bench: Bench,
        plan: Plan,
        *,
        clock: Clock,
        cancelled: Cancelled,
        say: Callable[[str], None],
    ) -> None:
        self._bench = bench
        self._plan = plan
        self._clock = clock
        self._cancelled = cancelled
        self._say = say
        self._burning: float | None = None
        self._capped: bool | None = None
        self._is_steady = False
        self._when_set: LightState | None = None
        self._seen: LightState | None = None

    def set_for(self, step: Step) -> None:
        """Return once the light that `step` asks for is there, and steady where it is seen."""
        self._show(step.block.scene)
        if step.capped and self._bench.caps_by_lamps_off:
            self._cap(capped=True)
            self.forget()
        else:
            self._cap(step.capped)
            self._burn(step.burning)
        if not step.capped and step.burning > 0 and not self._is_steady:
            self._settle(step.burning)
        if step.wait_s > 0:
            wait(step.wait_s, self._clock, self._cancelled)
            self._seen = None
        if self._cancelled():
            raise RunCancelledError

    def leave(self, step: Step) -> None:
        """Hold the lamps after `step` as the plan says."""
        if step.off_afterwards:
            self._say("lamps off, as the plan says")
            self._bench.safe_off()
            self.forget()

    def read_back(self, step: Step, *, before: bool) -> ReadBack:
        """Ask every device how it is; raise DeviceError, code `lamp-out`, when a lamp is not.

        Right after a block, or after the lamps were set, they are not asked once more `before` the
        next one, since a slow line takes seconds; what happens meanwhile shows after that block.
        """
        now = read_back(self._bench, self._seen if before else None)
        by_lamps_off = step.capped and self._bench.caps_by_lamps_off
        check_burning(
            self._bench.light,
            now.light,
            wanted=0.0 if by_lamps_off else step.burning,
            when_set=self._when_set,
            block=step.block.block,
        )
        self._seen = now.light
        return now

    def forget(self) -> None:
        """Believe nothing of the lamps."""
        self._burning, self._is_steady = None, False
        self._when_set = self._seen = None

    def _show(self, scene: str | None) -> None:
        target = self._bench.target
        if target is not None:
            target.show(scene)
        elif scene is not None:
            raise DeviceError(
                f"nobody can be asked to put the target {scene} before the lens; run the plan at a"
                " terminal, or take its scenes out",
                device="target",
                code="no-operator",
            )

    def _cap(self, capped: bool) -> None:
        if self._capped != capped:
            self._bench.shutter.set_capped(capped)
            self._capped = capped

    def _burn(self, level: float) -> None:
        if self._burning == level:
            return
        self._say(f"setting level {level:g}")
        self.forget()
        state = self._bench.light.set_level(level, self._cancelled)
        if self._cancelled():
            raise RunCancelledError
        self._burning, self._when_set, self._seen = level, state, state

    def _settle(self, level: float) -> None:
        self._say(f"waiting until level {level:g} is steady")
        wait_until_steady(
            self._bench.monitor,
            self._plan.settle,
            level,
            clock=self._clock,
            cancelled=self._cancelled,
        )
        self._is_steady, self._seen = True, None
