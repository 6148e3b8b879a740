"""The process that does one job, seen from inside and from outside."""

import logging
import multiprocessing
import os
import signal
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from multiprocessing.connection import Connection
from typing import Any

from calib.errors import DarkflatError
from service.api.jobs.work import KINDS
from service.watching.log import log_of_child

_LOG = logging.getLogger(__name__)
DEFECT = ("internal-error", "a defect in darkflat; its log says more")


@dataclass(frozen=True)
class Done:
    """How the work ended: with a result, or with an error's code and message."""

    result: dict[str, Any] | None = None
    error: tuple[str, str] | None = None


def do(kind: str, request: Mapping[str, Any], tell: Callable[[float], None]) -> Done:
    """Do the work here and now, and say how it ended."""
    try:
        return Done(result=KINDS[kind](request, tell))
    except DarkflatError as error:
        return Done(error=(error.code, str(error)))
    except OSError as error:
        return Done(error=("system-error", f"{error.strerror or error}"))
    except Exception:
        _LOG.exception("a %s failed", kind)
        return Done(error=DEFECT)


def _work(kind: str, request: Mapping[str, Any], pipe: Connection) -> None:
    """Do the work in the new process; Ctrl-C at the server's terminal is the server's business."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    os.nice(5)  # the API answers first
    # Read when NumPy is first imported, which is later: BLAS threads of one job would wait for each
    # other longer than they work, and keep the API waiting too.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    log_of_child().job = str(request.get("job", ""))
    pipe.send(do(kind, request, pipe.send))


class JobProcess:
    """One job under way; killing it is how it is cancelled."""

    def __init__(self, kind: str, request: Mapping[str, Any]) -> None:
        context = multiprocessing.get_context("spawn")  # forking a threaded server deadlocks
        self._pipe, theirs = context.Pipe(duplex=False)
        self._process = context.Process(
            target=_work, args=(kind, dict(request), theirs), daemon=True, name=f"darkflat-{kind}"
        )
        self._process.start()
        theirs.close()

    def wait(self, tell: Callable[[float], None]) -> Done:
        """Return how it ended; `tell` is given the share that is done meanwhile."""
        try:
            while True:
                said = self._pipe.recv()
                if isinstance(said, Done):
                    return said
                tell(float(said))
        except EOFError:
            self._process.join()
            text = (
                f"the work's process died (exit status {self._process.exitcode}); submit it again"
            )
            return Done(error=("worker-died", text))
        finally:
            self._process.join()
            self._pipe.close()

    def kill(self) -> None:
        """End it at once; safe at any time."""
        self._process.kill()
