"""Which other effects would explain a finding as well, and how sure its name is."""

from dataclasses import dataclass
from math import exp
from typing import NamedTuple

from calib.diagnosis.naming.contest import Contest
from calib.diagnosis.naming.imperfection import left_by_others
from calib.diagnosis.naming.model import Model
from calib.diagnosis.naming.refit import misfit
from calib.diagnosis.naming.unnamed import odds_of_none
from calib.diagnosis.shapes.shape import Shape
from calib.diagnosis.signatures.template_error import temper

MOST_CANDIDATES = 3
HELD = 0.995
"""Names are told until their probabilities make up this much of all names'."""
CLOSE = 25.0
"""Only names within so much tempered deviance of the best one are fitted."""
MOST_FITTED = 2
RATES = "rates_e_per_us"
"""A parameter whose numbers are each fitted to a pixel of its own."""


@dataclass(frozen=True)
class Candidate:
    """One name for a finding.

    Attributes:
        effect: Its name.
        probability: That it is this; of all candidates together, that it is one of the catalogue.
        gain: Deviance that it explains beside the other effects, after its price.
    """

    effect: str
    probability: float
    gain: float


class Explained(NamedTuple):
    """What a name explains in the place of a finding, as deviance, and its price.

    Of that, `pixels` numbers have cost 2 each that were fitted to one pixel each.
    """

    deviance: float
    price: float
    pixels: float = 0.0

    @property
    def net(self) -> float:
        """What is left of it after the price."""
        return self.deviance - self.price

    def price_at(self, tempered: float) -> float:
        """Return the price where deviance counts so much.

        What a pixel's own number explains by chance, 1, and spoils elsewhere, as much, is a part of
        what is explained, and counts as that does: thousands of them would outweigh all of it.
        """
        return self.price - 2.0 * self.pixels * (1.0 - tempered)


def candidates_of(k: int, model: Model, contest: Contest) -> tuple[Candidate, ...]:
    """Return the names that member `k` of the model could have, the likeliest first."""
    explained, evidence = explained_by(k, model, contest), contest.evidence
    own = explained[model.members[k].signature.shape.name]
    none = odds_of_none(own.net, left_by_others(k, model, evidence))
    return told(explained, temper(contest.own_gain(model, k)), none)


def explained_by(k: int, model: Model, contest: Contest) -> dict[str, Explained]:
    """Return what each name would explain in the place of member `k`, and its price."""
    member, gain = model.members[k], contest.own_gain(model, k)
    own = _explained(gain, contest.price_of(member), member.signature.shape)
    ranked = contest.ranking(model, k, worth=own.net - 2.0 * CLOSE / temper(gain))
    found = {member.signature.shape.name: own}
    left, now = misfit(model, contest.evidence), contest.penalised(model)
    for n, score in enumerate(ranked):
        shape = score.signature.shape
        each = _explained(score.gain, score.gain - score.net, shape)
        if n < MOST_FITTED and temper(gain) * (own.net - score.net) < CLOSE:
            fitted = contest.placed(model, k, score)
            deviance = gain + left - misfit(fitted, contest.evidence)
            price = deviance - own.net - now + contest.penalised(fitted)
            each = _explained(deviance, price, shape)
        # The search has found nothing that is better, and what is not fitted is no proof of it.
        dearer = each.price_at(temper(gain)) - own.price_at(temper(gain))
        most = own.deviance + dearer / temper(gain)
        found[score.name] = each._replace(deviance=min(each.deviance, most))
    return found


def _explained(deviance: float, price: float, shape: Shape) -> Explained:
    """Return what is explained with what whitened counts have less of, or more, which is no price.

    What single codes contradict hangs on shapes as all that is explained does.
    """
    credit = max(-shape.cost, 0.0) + min(shape.credit + shape.of_codes, 0.0)
    rates = [unit for name, unit, _ in shape.varied if name == RATES and isinstance(unit, tuple)]
    pixels = min(float(sum(map(len, rates))), shape.freedom)
    return Explained(deviance + credit, price + credit, pixels)


def told(
    explained: dict[str, Explained], tempered: float, none: float = 0.0
) -> tuple[Candidate, ...]:
    """Return the likeliest names and their probabilities.

    Errors of signatures temper what is explained; a price, the odds before anything was seen and
    what freedom costs, they do not. Against the names stand the odds of `none` of them.
    """
    odds = {
        name: 0.5 * (tempered * one.deviance - one.price_at(tempered))
        for name, one in explained.items()
    }
    top = max(odds.values())
    weights = {name: exp(each - top) for name, each in odds.items()}
    named = sum(weights.values())
    total = (1.0 + none) * named
    found = sorted(
        (Candidate(name, w / total, explained[name].net) for name, w in weights.items()),
        key=lambda candidate: -candidate.probability,
    )
    kept: list[Candidate] = []
    for each in found[:MOST_CANDIDATES]:
        if sum(c.probability for c in kept) < HELD * named / total:
            kept.append(each)
    return tuple(kept)
