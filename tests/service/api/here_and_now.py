"""Jobs without a process of their own, which takes seconds to begin."""

from collections.abc import Callable, Mapping
from typing import Any

from service.api.jobs.process import Done, do


class HereAndNow:
    """In place of a job's process: the work itself, where the process is not what is tried."""

    def __init__(self, kind: str, request: Mapping[str, Any]) -> None:
        self._kind, self._request = kind, request

    def wait(self, tell: Callable[[float], None]) -> Done:
        return do(self._kind, self._request, tell)

    def kill(self) -> None:
        """It ends by itself."""
