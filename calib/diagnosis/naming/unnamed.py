"""The chance that a finding is none of the effects that the catalogue has.

A name is one among those of the catalogue. What the catalogue does not have, or a shape that a
family does not, may look alike: of a pattern at the angle theta from the name's, which explains a
deviance G of it, about G tan^2 theta is left, and it goes unseen where that is within what chance
and errors of stronger effects excuse. The weaker a finding, and the stronger what is found beside
it, the wider the angle, and the more physics without a name may stand behind it: of patterns that
part from the name's in two directions at random, the share within that angle is
sin^2 theta = reach / (reach + G).
"""

from calib.diagnosis.naming.remainder import CERTAIN_SIGMA

BEFORE = 1.0
"""Odds, before anything was seen, of physics without a name against the finding's names.

Even, fitted to 238 candidates of findings in opened recordings of the proof, which have unlisted
physics and unlisted shapes among them: 0.90, and the likelihood of what was true falls to exp(-1/2)
at 0.67 and 1.22. Of 165 candidates stated above 0.9, 154 were right, 0.998 stated; so weighed, 119
of 122, 0.982 stated. One direction fits as well (odds of 0.37), four worse by 10 in deviance.
"""


def odds_of_none(gain: float, excused: float) -> float:
    """Return the odds of no name of the catalogue against those of a finding.

    Args:
        gain: Deviance that the finding's name explains, after its price.
        excused: Of that, what errors of other effects may leave.
    """
    reach = CERTAIN_SIGMA**2 + excused
    return BEFORE * reach / (reach + max(gain, 0.0))
