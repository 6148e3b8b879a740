"""In which order the flats are taken."""

from collections.abc import Sequence
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BeforeValidator, Field

from service.plan.part import PlanPart
from service.plan.sweeps import Point


class AsGiven(PlanPart):
    """As the sweep lists them."""

    type: Literal["as_given"] = "as_given"

    def arranged(self, points: Sequence[Point], repeat: int) -> tuple[Point, ...]:  # noqa: ARG002
        """Return the flats of one repeat in the order of acquisition."""
        return tuple(points)


class Reversed(PlanPart):
    """From the last to the first: with its counterpart, it separates drift from the sweep."""

    type: Literal["reversed"] = "reversed"

    def arranged(self, points: Sequence[Point], repeat: int) -> tuple[Point, ...]:  # noqa: ARG002
        """Return the flats of one repeat in the order of acquisition."""
        return tuple(reversed(points))


class Random(PlanPart):
    """Shuffled afresh for each repeat, so that drift becomes scatter; costs lamp cycles."""

    type: Literal["random"] = "random"
    seed: int = Field(ge=0)

    def arranged(self, points: Sequence[Point], repeat: int) -> tuple[Point, ...]:
        """Return the flats of one repeat in the order of acquisition."""
        rng = np.random.default_rng((self.seed, repeat))
        return tuple(points[int(i)] for i in rng.permutation(len(points)))


class LevelMajor(PlanPart):
    """Level by level from the lowest: each lamp is lit once per repeat."""

    type: Literal["level_major"] = "level_major"

    def arranged(self, points: Sequence[Point], repeat: int) -> tuple[Point, ...]:  # noqa: ARG002
        """Return the flats of one repeat in the order of acquisition."""
        return tuple(sorted(points, key=lambda point: point.level))


def tagged(value: Any) -> Any:
    """Read `"reversed"` as `{type = "reversed"}`: a word is enough where nothing is to be set."""
    return {"type": value} if isinstance(value, str) else value


Order = Annotated[
    AsGiven | Reversed | Random | LevelMajor,
    Field(discriminator="type"),
    BeforeValidator(tagged),
]
