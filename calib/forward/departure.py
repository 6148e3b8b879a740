"""Physics that a simulation may have left out: what a diagnosis looks for.

A departure is an effect of the chain like any other; it also says how it shows in a recording and
what a recording must hold to show it at all.
"""

from collections.abc import Sequence
from typing import ClassVar, Literal

from calib.forward.effect import Effect
from calib.recording.header import Block, CameraHeader

Statistic = Literal[
    "mean",
    "variance",
    "column_covariance",
    "line_covariance",
    "spectrum",
    "histogram",
    "tail",
    "transient",
]
"""Of a block: where a departure is seen first."""

Variable = Literal[
    "signal",
    "exposure",
    "level",
    "time",
    "temperature",
    "column",
    "tap",
    "line",
    "code",
    "previous_block",
]
"""What a departure follows."""


class Departure(Effect):
    """An effect that the baseline lacks: response, shot and read noise, rounding, clipping."""

    physics: ClassVar[str]
    """One sentence for an operator: what was left out, and its formula."""
    shows_in: ClassVar[Statistic]
    """The statistic in which it is seen first."""
    depends_on: ClassVar[tuple[Variable, ...]]
    """The variables that it follows, the telling one first."""
    any_law: ClassVar[Variable | None] = None
    """Of which it may be another function than the formula's, as its physics leaves that open."""
    open_profiles: ClassVar[bool] = False
    """True where how much the means of pixels side by side move, for the same covariances, is open:
    covariances alone tell the strength then."""

    smooth_law: ClassVar[Variable | None] = None
    """Likewise, but a smooth one."""

    @classmethod
    def why_not_testable(cls, blocks: Sequence[Block], camera: CameraHeader) -> str | None:  # noqa: ARG003
        """Return what a recording of `blocks` lacks to show the effect at any strength.

        None where it could show it. The words complete "needs": see `calib.forward.plan_needs`.
        """
        return None
