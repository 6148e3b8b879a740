"""One row of the table that `make bench` prints."""

from collections.abc import Mapping
from dataclasses import dataclass

from benchmarks.race import Figure


@dataclass(frozen=True)
class Row:
    """A measured rate, beside others of the same run, and the bound that it is held against.

    Attributes:
        work: What was done, on what size.
        unit: Of every rate.
        ours: The rate.
        numpy: The same with plain NumPy; None where it has no means for it.
        peers: The same with other projects' code, by name; empty where there is none, or where
            their environment is not installed.
        limit: What the machine itself allows.
        limit_is: What that limit is.
        bound: What has to be reached, in words.
        reached: Whether it is.
        notes: What else was measured, one sentence each.
    """

    work: str
    unit: str
    ours: float
    numpy: Figure | None
    peers: Mapping[str, Figure]
    limit: Figure
    limit_is: str
    bound: str
    reached: bool
    notes: tuple[str, ...] = ()
