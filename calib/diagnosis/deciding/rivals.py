"""What a finding could also be: each of its names fitted to the recording in its place."""

from dataclasses import dataclass

from calib.diagnosis.answer.diagnosis import AMBIGUOUS
from calib.diagnosis.answer.finding import Finding
from calib.diagnosis.diagnose import Examination
from calib.diagnosis.naming.contest import Contest
from calib.diagnosis.naming.contribution import contribution
from calib.diagnosis.naming.model import Member
from calib.diagnosis.naming.scores import scores
from calib.diagnosis.signatures.signature import retaken
from calib.diagnosis.simulation.fitted_responder import responder_of
from calib.forward.departure import Departure
from calib.forward.parameter import parameters_of

CLOSE = 16.0
"""Names within so much deviance of the likeliest one may be what is left."""
SHARE = 0.02
"""So may those within this share of what it explains: signatures are not exact."""
MOST = 4
"""So many names are told apart at a time."""
SHAPES = 3
"""Of a name are looked at closely."""
AS_GOOD = 4.0
"""Shapes that differ by less deviance fit as well: two standard deviations."""


@dataclass(frozen=True)
class Rivals:
    """Names that a recording cannot tell apart.

    Attributes:
        members: One for each name, as fitted beside the others.
        others: The other effects of the model.
    """

    members: tuple[Member, ...]
    others: tuple[Member, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """Their names, the likeliest first."""
        return tuple(member.effect.name for member in self.members)


def is_open(finding: Finding) -> bool:
    """Return whether a second name of a finding is probable."""
    return len(finding.candidates) > 1 and finding.candidates[1].probability >= AMBIGUOUS


def rivals_of(finding: Finding, examined: Examination) -> Rivals:
    """Return the names that a finding may have, each fitted in its place.

    Those that are not told since three others are likelier may be left when these are not.
    """
    members, evidence = examined.model.members, examined.evidence
    k = next(k for k, m in enumerate(members) if m.effect.name == finding.effect.name)
    contest = Contest(examined.signatures, evidence, responder_of(evidence))
    wanted = [finding.effect.name, *(c.effect for c in finding.candidates)]
    gain, least = contest.own_gain(examined.model, k), contest.own_gain(examined.model, k) - CLOSE
    close = [s.name for s in contest.ranking(examined.model, k) if s.net > least - SHARE * gain]
    wanted = list(dict.fromkeys([*wanted, *close]))[:MOST]
    fitted = [_fitted(name, k, examined, contest) for name in wanted]
    others = tuple(m for j, m in enumerate(members) if j != k)
    return Rivals(tuple(member for member in fitted if member is not None), others)


def _fitted(name: str, k: int, examined: Examination, contest: Contest) -> Member | None:
    """Return the effect of that name in the place of member `k`; None where it takes no part."""
    evidence, model = examined.evidence, examined.model
    own = model.members[k]
    if name == own.effect.name and _time_is_known(own):
        return own
    residual = model.residual + contribution(own)
    directions = [d for j, m in enumerate(model.members) if j != k for d in m.directions]
    shapes = [s for s in examined.signatures if s.shape.name == name]
    ranked = scores(shapes, residual, directions, evidence)[:SHAPES]
    sharper = [retaken(s.signature, s.amplitude, evidence, contest.responder) for s in ranked]
    again = scores(sharper, residual, directions, evidence)
    if not again or again[0].gain <= 0:
        return None
    as_good = [score for score in again if score.gain > again[0].gain - AS_GOOD]
    longest = max(as_good, key=lambda score: _times_s(score.signature.shape.template))
    return contest.placed(model, k, longest).members[k]


def _time_is_known(member: Member) -> bool:
    """Return whether the data determine how fast the effect goes, if it has such a time."""
    times = {name for name, told in parameters_of(type(member.effect)).items() if told.unit == "s"}
    return times <= member.inner.keys()


def _times_s(effect: Departure) -> float:
    """Return the sum of the effect's times: a drift whose end was not seen is taken to go on."""
    told = parameters_of(type(effect))
    return sum(float(getattr(effect, name)) for name, each in told.items() if each.unit == "s")
