"""Which other effects would explain a finding as well, and how sure its name is."""

from dataclasses import dataclass
from math import exp

from calib.diagnosis.naming.contest import Contest
from calib.diagnosis.naming.model import Model

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
    return told(nets_of(k, model, contest), temper(contest.own_gain(model, k)))


def nets_of(k: int, model: Model, contest: Contest) -> dict[str, float]:
    """Return what each name would explain in the place of member `k`, after its price."""
    member, gain = model.members[k], contest.own_gain(model, k)
    own = gain - contest.price_of(member)
    ranked = contest.ranking(model, k, worth=own - 2.0 * CLOSE / temper(gain))
    nets = {member.signature.shape.name: own}
    now = contest.penalised(model)
    for n, score in enumerate(ranked):
        net = score.net
        if n < MOST_FITTED and temper(gain) * (own - net) < CLOSE:
            net = own + now - contest.penalised(contest.placed(model, k, score))
        # The search has found nothing that is better, and what is not fitted is no proof of it.
        nets[score.name] = min(net, own)
    return nets


def told(nets: dict[str, float], tempered: float) -> tuple[Candidate, ...]:
    """Return the likeliest names and their probabilities."""
    top = max(nets.values())
    weights = {n: exp(0.5 * tempered * (v - top)) for n, v in nets.items()}
    total = sum(weights.values())
    found = sorted(
        (Candidate(n, w / total, nets[n]) for n, w in weights.items()),
        key=lambda candidate: -candidate.probability,
    )
    kept: list[Candidate] = []
    for each in found[:MOST_CANDIDATES]:
        if sum(c.probability for c in kept) < HELD:
            kept.append(each)
    return tuple(kept)
