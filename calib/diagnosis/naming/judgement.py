"""Which other effects would explain a finding as well, and how sure its name is."""

from dataclasses import dataclass
from math import exp
from typing import NamedTuple

from calib.diagnosis.naming.contest import Contest
from calib.diagnosis.naming.model import Model
from calib.diagnosis.naming.refit import misfit

TEMPLATE_ERROR = 0.03
"""By how much of its length a fitted signature errs, in any direction that parts two names."""
MOST_CANDIDATES = 3
HELD = 0.995
"""Names are told until their probabilities make up this much."""
CLOSE = 25.0
"""Only names within so much tempered deviance of the best one are fitted."""
MOST_FITTED = 2


@dataclass(frozen=True)
class Candidate:
    """One name for a finding.

    Attributes:
        effect: Its name.
        probability: Among the candidates.
        gain: Deviance that it explains beside the other effects, after its price.
    """

    effect: str
    probability: float
    gain: float


class Explained(NamedTuple):
    """What a name explains in the place of a finding, as deviance, and its price."""

    deviance: float
    price: float

    @property
    def net(self) -> float:
        """What is left of it after the price."""
        return self.deviance - self.price


def temper(gain: float, error: float = TEMPLATE_ERROR) -> float:
    """Return by which factor differences of deviance count, of a finding that explains `gain`.

    Two names part by the deviance D = d^2, d the distance of their signatures. Were these exact,
    the difference of what they explain would scatter by 2 d. A signature of length sqrt(gain) that
    errs by a share e of its length moves the difference by another 2 d e sqrt(gain): the
    logarithm of the odds, D of variance 4 D (1 + e^2 gain), is D / (1 + e^2 gain).
    """
    return 1.0 / (1.0 + error**2 * max(gain, 0.0))


def candidates_of(k: int, model: Model, contest: Contest) -> tuple[Candidate, ...]:
    """Return the names that member `k` of the model could have, the likeliest first."""
    return told(explained_by(k, model, contest), temper(contest.own_gain(model, k)))


def explained_by(k: int, model: Model, contest: Contest) -> dict[str, Explained]:
    """Return what each name would explain in the place of member `k`, and its price."""
    member, gain = model.members[k], contest.own_gain(model, k)
    own = Explained(gain, contest.price_of(member))
    ranked = contest.ranking(model, k, worth=own.net - 2.0 * CLOSE / temper(gain))
    found = {member.signature.shape.name: own}
    left, now = misfit(model, contest.evidence), contest.penalised(model)
    for n, score in enumerate(ranked):
        each = Explained(score.gain, score.gain - score.net)
        if n < MOST_FITTED and temper(gain) * (own.net - score.net) < CLOSE:
            fitted = contest.placed(model, k, score)
            deviance = gain + left - misfit(fitted, contest.evidence)
            each = Explained(deviance, deviance - own.net - now + contest.penalised(fitted))
        # The search has found nothing that is better, and what is not fitted is no proof of it.
        better = max(each.net - own.net, 0.0)
        found[score.name] = Explained(each.deviance - better, each.price)
    return found


def told(explained: dict[str, Explained], tempered: float) -> tuple[Candidate, ...]:
    """Return the likeliest names and their probabilities.

    Errors of signatures temper what is explained; a price, the odds before anything was seen and
    what freedom costs, they do not.
    """
    odds = {name: 0.5 * (tempered * one.deviance - one.price) for name, one in explained.items()}
    top = max(odds.values())
    weights = {name: exp(each - top) for name, each in odds.items()}
    total = sum(weights.values())
    found = sorted(
        (Candidate(name, w / total, explained[name].net) for name, w in weights.items()),
        key=lambda candidate: -candidate.probability,
    )
    kept: list[Candidate] = []
    for each in found[:MOST_CANDIDATES]:
        if sum(c.probability for c in kept) < HELD:
            kept.append(each)
    return tuple(kept)
