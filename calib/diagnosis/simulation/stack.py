"""Stretches of lines of several blocks, one after the other, that run through a chain together."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from calib.arrays import Columns
from calib.diagnosis.recorded.conditions_table import ConditionsTable
from calib.forward.conditions import Conditions
from calib.forward.left import Left

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Stack:
    """Stretches of lines.

    Attributes:
        blocks: The block of each stretch, (n_parts,).
        at: The conditions of its lines, likewise.
        key: Stacks of one key are alike but for what was left in the pixels before.
    """

    blocks: tuple[int, ...]
    at: tuple[Conditions, ...]
    key: str

    @classmethod
    def of(cls, table: ConditionsTable, lines: Sequence[tuple[int, Columns]], key: str) -> "Stack":
        """Return the stack of (block, lines counted from the block's first)."""
        return cls(tuple(b for b, _ in lines), tuple(table.at(b, n) for b, n in lines), key)

    def before(self, lefts: Sequence[Left | None]) -> "Stack":
        """Return the stack with what each stretch finds in the pixels."""
        if all(left is None for left in lefts):
            return self
        found = (replace(a, before=left) for a, left in zip(self.at, lefts, strict=True))
        return replace(self, at=tuple(found))

    @cached_property
    def parts(self) -> tuple[slice, ...]:
        """Where each stretch stands among all lines."""
        ends = np.cumsum([a.n_lines for a in self.at]).tolist()
        return tuple(slice(e - a.n_lines, e) for e, a in zip(ends, self.at, strict=True))

    @property
    def n_lines(self) -> int:
        """Lines of all stretches."""
        return int(self.parts[-1].stop)

    def by_line(self, values: Sequence[float], n_axes: int) -> Floats:
        """Return one value of each stretch for each of its lines, with axes up to `n_axes`."""
        counts = [a.n_lines for a in self.at]
        return np.repeat(np.asarray(values), counts).reshape(-1, *(1,) * (n_axes - 1))
