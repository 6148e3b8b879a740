"""Effects whose lines depend on lines before them, also on those of an earlier draw.

A draw hands on what it left in the pixels (`Drawn.left`); the next one finds it in its conditions
(`Conditions.before`). So the lines of a block stay related, whatever frames they come in. A block
that is drawn without the ones before it finds what these leave on average (`expected_left`): its
lines then do not depend on how many of theirs were asked for.
"""

from abc import abstractmethod
from typing import Any

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from calib.arrays import Lines, Pixels
from calib.forward.conditions import Conditions
from calib.forward.departure import Departure


class Remembering(Departure):
    """A departure with memory: `carry` in place of `apply`."""

    @abstractmethod
    def carry(self, signal: Lines, at: Conditions, rng: Generator) -> tuple[Lines, Pixels]:
        """Return the signal after this effect, (n_lines, *sample), and what it leaves, (*sample,).

        What was left before is in `at.before`; None there is a sensor at rest.
        """

    @abstractmethod
    def expected_left(self, signal: Lines, at: Conditions) -> Pixels:
        """Return the expectation of what `carry` leaves, (*sample,), without drawing.

        Args:
            signal: The expected signal before this effect, (n_lines, *sample), or (1, *sample)
                where all lines are taken to be alike.
            at: The conditions of all n_lines lines, with what was left before.
        """

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:
        """Return the signal after this effect, (n_lines, *sample); never change `signal`."""
        return self.carry(signal, at, rng)[0]


class LineByLine(Remembering):
    """One in which each pixel goes from line to line by itself, by a law that is always the same.

    Several stretches of lines, each with what it found, may lie side by side like pixels.
    """

    @abstractmethod
    def found(
        self, sample: tuple[int, ...], at: Conditions, rng: Generator
    ) -> NDArray[np.float64 | np.int64]:
        """Return what is in the pixels before the first line, (*sample,)."""

    @abstractmethod
    def carried(
        self, signal: Lines, found: NDArray[Any], at: Conditions, rng: Generator
    ) -> tuple[Lines, Pixels]:
        """Return what `carry` does, of pixels that held `found` before, (*sample,).

        Of `at`, only what all stretches have in common may be looked at.
        """

    def carry(self, signal: Lines, at: Conditions, rng: Generator) -> tuple[Lines, Pixels]:
        """Return the signal after this effect, (n_lines, *sample), and what it leaves."""
        return self.carried(signal, self.found(signal.shape[1:], at, rng), at, rng)


def sum_over_lines(weights: NDArray[np.floating], signal: Lines) -> Pixels:
    """Return the lines' weighted sum, (*sample,); one line, (1, *sample), stands for all.

    >>> sum_over_lines(np.array([1.0, 2.0]), np.array([[10.0]]))
    array([30.])
    """
    if len(signal) == 1:
        return np.asarray(weights.sum() * signal[0])
    return np.asarray(np.tensordot(weights, signal, axes=1))
