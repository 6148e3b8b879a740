"""Faults of whole codes: each sample has one or not, by chance of its own.

What such a fault does to codes is a map, so that what it does to a pixel's histogram, mean and
noise follows from its codes without the fault, and nothing needs to be drawn.
"""

from abc import abstractmethod

from calib.arrays import Lines
from calib.forward.departure import Departure


class CodeFault(Departure):
    """A departure that maps the codes which the converter gives, after all else."""

    @property
    @abstractmethod
    def chance(self) -> float:
        """With which a sample has the fault, 0 to 1."""

    @abstractmethod
    def faulty(self, codes: Lines) -> Lines:
        """Return what whole codes become that have it, of any shape."""
