"""After safe-off the bench stays dark, and queued runs wait, until somebody wants light again."""

import threading
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Final

from service.store.actor import Actor
from service.store.audit import Audit

SAFE_OFF: Final = "bench.safe-off"
RELEASE: Final = "bench.release"


@dataclass(frozen=True)
class KeptDark:
    """Who pressed safe-off, and when."""

    by: str
    since: datetime


class Darkness:
    """Whether a bench is kept dark. Thread-safe; it begins as the audit log says.

    Attributes:
        kept: By whom; None where runs may begin.
    """

    def __init__(self, audit: Audit, bench_id: str) -> None:
        self._audit = audit
        self._bench_id = bench_id
        self._lock = threading.Lock()
        self.kept = _by_the_log(audit, bench_id)

    def begin(self, by: Actor) -> None:
        """Let no run begin from now on; waits for nothing, so the log is written afterwards."""
        with self._lock:
            self.kept = KeptDark(by.name, datetime.now(UTC))

    def record(self, by: Actor) -> None:
        """Put on record that safe-off was pressed."""
        self._audit.record(by, SAFE_OFF, self._bench_id)

    def end(self, by: Actor) -> None:
        """Let runs begin, unless safe-off is pressed again meanwhile; nothing where they may."""
        known = self.kept
        if known is None:
            return
        self._audit.record(by, RELEASE, self._bench_id, before={"kept_dark_by": known.by})
        with self._lock:
            if self.kept is known:
                self.kept = None


def _by_the_log(audit: Audit, bench_id: str) -> KeptDark | None:
    last = audit.newest(bench_id, {SAFE_OFF, RELEASE})
    if last is None or last.action == RELEASE:
        return None
    return KeptDark(last.who, last.at)
