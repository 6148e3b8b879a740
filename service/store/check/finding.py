"""What a look through the store found."""

from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path


class Kind(StrEnum):
    """What is the matter with it."""

    MISSING = "missing"
    ALTERED = "altered"
    """It is not what the record says, or cannot be read."""
    ORPHANED = "orphaned"
    """No record names it."""
    HALF_WRITTEN = "half-written"
    """It never got its name: its writer was killed, or writes now."""

    @property
    def is_harm(self) -> bool:
        """Tell whether something was lost; what is left over only takes room."""
        return self in {Kind.MISSING, Kind.ALTERED}


@dataclass(frozen=True)
class Finding:
    """One thing: what it is about, where it lies, and one sentence that says what to do."""

    kind: Kind
    subject: str
    path: Path | None
    text: str
