"""Stretches of lines that a memory goes through at one time, in place of one after the other.

What one line leaves for the next is the same law in all stretches. They lie side by side then, like
pixels of one long line, and each gets the numbers of its own generator, in their order.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.random import PCG64
from numpy.typing import ArrayLike, NDArray

from calib.diagnosis.simulation.designed_noise import DesignedNoise
from calib.forward.conditions import Conditions
from calib.forward.moments import Moments
from calib.forward.remembering import LineByLine

Floats = NDArray[np.float64]

_SHARED = PCG64(0)
"""Nothing is drawn from it."""


class SideBySide(Moments):
    """Answers for one line of each of several stretches, (n_stretches, *sample)."""

    def __init__(self, each: Sequence[DesignedNoise], *, noise: float) -> None:
        """Answer with what `each` stretch's own generator does; see there for `noise`."""
        super().__init__(_SHARED, noise=abs(noise))
        self._each = tuple(each)

    def binomial(self, n: ArrayLike, p: ArrayLike, size: Any = None) -> Any:
        """Return smooth numbers; none comes of less than nothing."""
        for one in self._each:
            one.asked_for(p)
        return super().binomial(np.maximum(n, 0.0), p, size)

    def standard_normal(self, size: Any = None, *_: Any, **__: Any) -> Any:
        """Return each stretch's own numbers, of whatever sign its generator has them."""
        return np.stack([one.standard_normal(size[1:]) for one in self._each])


def carried_together(
    link: LineByLine,
    signal: Floats,
    parts: Sequence[slice],
    at: Sequence[Conditions],
    each: Sequence[DesignedNoise],
    *,
    noise: float,
) -> Floats:
    """Return the signal after a link that remembers, (n_lines, *sample).

    Args:
        link: The link.
        signal: Of the lines of all stretches.
        parts: Where each stretch stands among them.
        at: Its conditions.
        each: Its generator.
        noise: As theirs.
    """
    after = np.empty_like(signal)
    lengths = np.array([a.n_lines for a in at])
    for n in np.unique(lengths):
        which = np.flatnonzero(lengths == n).tolist()
        rng = SideBySide([each[k] for k in which], noise=noise)
        sample = signal.shape[1:]
        found = np.stack([link.found(sample, at[k], each[k]) for k in which])
        lines = np.stack([signal[parts[k]] for k in which], axis=1)
        read, _ = link.carried(lines, found, at[which[0]], rng)
        for k, own in zip(which, np.moveaxis(read, 1, 0), strict=True):
            after[parts[k]] = own
    return after
