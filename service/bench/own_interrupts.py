"""Start processes that Ctrl-C does not reach."""

import signal
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def interrupts_kept_from_children() -> Iterator[None]:
    """Let processes that are started inside inherit a mask that holds SIGINT back for good.

    A terminal sends Ctrl-C to every process of its group. Emulated lamps must outlive it, or the
    owner of the bench could not switch them off any more. In this thread it waits until the end.
    """
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
