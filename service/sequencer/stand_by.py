"""A run that stands still for a while, its lamps as the plan says."""

from collections.abc import Callable

from drivers.ports import Cancelled
from service.bench.bench import Bench
from service.plan.model import Plan
from service.sequencer.control import RunControl
from service.sequencer.errors import RunCancelledError
from service.sequencer.events import RunState
from service.sequencer.surroundings import Surroundings

_SLICE_S = 0.2


class StandBy:
    """Knows whether what goes on is to be broken off, and waits until the run may go on."""

    def __init__(
        self,
        bench: Bench,
        plan: Plan,
        control: RunControl,
        cancelled: Cancelled,
        turn: Callable[[RunState, str], None],
    ) -> None:
        self._bench = bench
        self._lamps = plan.lamps.while_paused
        self._control = control
        self._cancelled = cancelled
        self._turn = turn

    def breaks(self) -> bool:
        """Tell whether a frame, a reading or a wait is to be broken off."""
        return self._control.breaks() or self._cancelled()

    @property
    def ends(self) -> bool:
        """True where the run is to end, not only to stand still."""
        return self._control.is_aborting or self._cancelled()

    def until_going_on(self, surroundings: Surroundings) -> None:
        """Return once the run may go on; after a pause nothing is believed of the light.

        Raises:
            RunCancelledError: It is to end.
        """
        if self.ends:
            raise RunCancelledError
        if not self._control.breaks():
            return
        if self._lamps == "off":
            self._bench.safe_off()
        surroundings.forget()
        self._turn("paused", f"paused, lamps {self._lamps}")
        while not self._control.wait_while_pausing(_SLICE_S) or self.ends:
            if self.ends:
                raise RunCancelledError
        self._turn("running", "going on after a pause")
