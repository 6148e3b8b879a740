"""What others ask of a run while it goes on."""

import threading


class RunControl:
    """Asked from any thread; the run's own thread asks it between frames, readings and waits.

    A pause that is taken back at once has interrupted the run all the same: what was begun may be
    half done, so `breaks` stays true until the run has taken note.
    """

    def __init__(self) -> None:
        self._aborting = threading.Event()
        self._going_on = threading.Event()
        self._going_on.set()
        self._interrupted = False
        self._lock = threading.Lock()

    def abort(self) -> None:
        """End the run for good; its lamps go off."""
        self._aborting.set()
        self._going_on.set()

    def pause(self) -> None:
        """Stop before the next frame; the step that is interrupted is done again."""
        with self._lock:
            self._going_on.clear()
            self._interrupted = True

    def resume(self) -> None:
        """Go on."""
        self._going_on.set()

    @property
    def is_aborting(self) -> bool:
        """True once somebody asked for the end."""
        return self._aborting.is_set()

    @property
    def is_pausing(self) -> bool:
        """True while the run is to stand still."""
        return not self._going_on.is_set() and not self.is_aborting

    def breaks(self) -> bool:
        """Tell whether what goes on is to be broken off."""
        return self._interrupted or self.is_aborting

    def wait_while_pausing(self, longest_s: float) -> bool:
        """Wait until the run may go on, `longest_s` at most; tell whether it may.

        Then what was broken off counts as dealt with.
        """
        if not self._going_on.wait(longest_s):
            return False
        with self._lock:
            if self._going_on.is_set():
                self._interrupted = False
        return not self._interrupted
