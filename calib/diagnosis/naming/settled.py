"""Which of a fit's turns to keep: the one that is consistent, not the one that happens to fit best.

The first turn is about a baseline that was fitted without the effects, and is bent by them. It
explains as much as any other, with strengths that are off by about their own size relative to what
is bent: a nonlinearity of 2 % came out 4 % too strong. So what has least to go counts for more than
a little deviance.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from calib.diagnosis.naming.model import Model

STALLED = 2
"""So many turns that lead nowhere end a fit: codes, and single events, make it scatter."""
ALIKE = 9.0
"""Fits that differ by less deviance are as good, but for where the baseline was."""
BENT = 0.01
"""So are those that differ by less of what they explain."""


@dataclass(frozen=True)
class Turn:
    """One turn of a fit.

    Attributes:
        model: As it was.
        ahead: The largest step that it asks for, standard deviations.
        misfit: What it leaves.
    """

    model: Model
    ahead: float
    misfit: float


def stalled(turns: Sequence[Turn]) -> bool:
    """Return whether the last turns led neither to smaller steps nor to a better fit.

    The first one is no measure of that: about its bent baseline it may have nothing to go.
    """
    before, last = turns[1:-STALLED], turns[-STALLED:]
    if not before:
        return False
    least = min(turn.misfit for turn in before)
    smallest = min(turn.ahead for turn in before)
    return all(turn.ahead >= smallest and turn.misfit >= least for turn in last)


def most_settled(turns: Sequence[Turn], nothing: float) -> Model:
    """Return the fit that has least to go of those that explain as much as the best.

    Args:
        turns: All of them.
        nothing: The misfit without any effect.
    """
    best = min(turns, key=lambda turn: turn.misfit)
    if any(member.signature.shape.freedom for member in best.model.members):
        # What was told by the residual of the first baseline goes with that one.
        return best.model
    enough = best.misfit + max(ALIKE, BENT * (nothing - best.misfit))
    fine = [turn for turn in turns[1:] if turn.misfit <= enough]
    return min(fine, key=lambda turn: turn.ahead).model if fine else best.model
