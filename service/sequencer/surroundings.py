"""What burns, whether the lens is capped, and since when the light is steady."""

from collections.abc import Callable

from drivers.errors import DeviceError
from drivers.ports import Cancelled, LightState
from service.bench.bench import Bench
from service.plan.model import Plan
from service.plan.step import Step
from service.sequencer.clock import Clock, wait
from service.sequencer.errors import RunCancelledError
from service.sequencer.settle import wait_until_steady

_LEVEL_TOLERANCE = 0.005
"""Of the highest level: an LED's setting is rounded to its step."""


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

    def set_for(self, step: Step) -> None:
        """Return once the light that `step` asks for is there, and steady where it is seen."""
        if step.capped and self._bench.caps_by_lamps_off:
            self._cap(capped=True)
            self._burning, self._is_steady = None, False
        else:
            self._cap(step.capped)
            self._burn(step.burning)
        if not step.capped and step.burning > 0 and not self._is_steady:
            self._settle(step.burning)
        wait(step.wait_s, self._clock, self._cancelled)
        if self._cancelled():
            raise RunCancelledError

    def leave(self, step: Step) -> None:
        """Hold the lamps after `step` as the plan says."""
        if step.off_afterwards:
            self._say("lamps off, as the plan says")
            self._bench.safe_off()
            self._burning, self._is_steady = None, False

    def check_burning(self, step: Step, state: LightState) -> None:
        """Raise DeviceError, code `lamp-out`, when another level burns than `step` asks for."""
        by_lamps_off = step.capped and self._bench.caps_by_lamps_off
        wanted = 0.0 if by_lamps_off else step.burning
        if abs(state.level - wanted) > _LEVEL_TOLERANCE * self._bench.light.max_level:
            out = [str(i + 1) for i, lamp in enumerate(state.lamps) if not lamp.on]
            raise DeviceError(
                f"level {wanted:g} should burn in block {step.block.block}, but level"
                f" {state.level:g} reads back (off: lamp {', '.join(out) or 'none'});"
                " replace the lamp or look at its supply, then resume",
                device=self._bench.light.identity.address or "light",
                code="lamp-out",
            )

    def _cap(self, capped: bool) -> None:
        if self._capped != capped:
            self._bench.shutter.set_capped(capped)
            self._capped = capped

    def _burn(self, level: float) -> None:
        if self._burning == level:
            return
        self._say(f"setting level {level:g}")
        self._burning, self._is_steady = None, False
        self._bench.light.set_level(level, self._cancelled)
        if self._cancelled():
            raise RunCancelledError
        self._burning = level

    def _settle(self, level: float) -> None:
        self._say(f"waiting until level {level:g} is steady")
        wait_until_steady(
            self._bench.monitor,
            self._plan.settle,
            level,
            clock=self._clock,
            cancelled=self._cancelled,
        )
        self._is_steady = True
