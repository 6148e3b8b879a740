"""What takes a course in time, whatever it is that drifts."""

from dataclasses import dataclass
from typing import ClassVar, Self

from numpy.random import Generator

from tests.concealed.generator import courses
from tests.concealed.generator.mechanism import Mechanism, Pixels, drifting_sign
from tests.concealed.generator.scan import Scan
from tests.concealed.generator.setting import Setting


@dataclass(frozen=True)
class Drifting(Mechanism):
    """Up or down by `strength` in the course of the recording."""

    shapes: ClassVar[tuple[str, ...]] = courses.KNOWN
    foreign: ClassVar[tuple[str, ...]] = courses.FOREIGN

    sign: float
    constant: float

    @classmethod
    def draw(cls, strength: float, shape: str, setting: Setting, rng: Generator) -> Self:
        return cls(strength, shape, drifting_sign(rng), courses.draw_constant(rng))

    def change(self, scan: Scan) -> Pixels:
        """Return the change at each sample."""
        return self.sign * self.strength * courses.course(self.shape, self.constant, scan.share)
