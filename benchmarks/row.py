"""One row of the table that `make bench` prints."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Row:
    """A measured figure and the bound that it is held against.

    Attributes:
        work: What was done, on what size.
        ours: The figure, with its unit.
        numpy: The same with plain NumPy in the same run.
        peer: The same with another project's code in the same run; why not, where not.
        limit: What the machine itself allows, measured in the same run.
        bound: What the figure has to reach, in words.
        reached: Whether it does.
    """

    work: str
    ours: str
    numpy: str
    peer: str
    limit: str
    bound: str
    reached: bool
