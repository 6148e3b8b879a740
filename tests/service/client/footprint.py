"""What a process holds: memory of its own, handles, threads."""

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Footprint:
    """One process at one moment.

    Attributes:
        own_bytes: Memory that is its own (RssAnon), not pages of files that are mapped.
        handles: Open file descriptors.
        threads: Of the process.
    """

    own_bytes: int
    handles: int
    threads: int

    @classmethod
    def of(cls, pid: int) -> "Footprint":
        """Return that of `pid`, from /proc."""
        text = Path(f"/proc/{pid}/status").read_text()
        status = dict(line.split(":", 1) for line in text.splitlines())
        own_kib = int(status["RssAnon"].split()[0])
        handles = sum(1 for _ in Path(f"/proc/{pid}/fd").iterdir())
        return cls(own_kib << 10, handles, int(status["Threads"]))
