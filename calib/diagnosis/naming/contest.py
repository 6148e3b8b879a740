"""Names that compete for one place of a model: each is fitted in it, with all that it can adapt.

What a signature explains before it is fitted tells little of how names compare: strong effects
bend, and grids are coarse. The likeliest few are fitted, inner parameters and all, beside the
other effects; what is left then, and what each shape's freedom costs, is what they are told apart
by.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import log, pi, sqrt

from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.evidence.point import Point
from calib.diagnosis.evidence.projection import orthonormal, without
from calib.diagnosis.naming.contribution import contribution, unfitted
from calib.diagnosis.naming.courses import PRICE
from calib.diagnosis.naming.freeing import with_free_law
from calib.diagnosis.naming.known_fits import KnownFits
from calib.diagnosis.naming.laws import open_variable
from calib.diagnosis.naming.model import Member, Model
from calib.diagnosis.naming.refit import misfit, refitted
from calib.diagnosis.naming.scores import Score, best_by_name, scores, sharpened
from calib.diagnosis.shapes.shape import Shape
from calib.diagnosis.signatures.changes import change_of
from calib.diagnosis.signatures.code_credit import with_code_credit
from calib.diagnosis.signatures.signature import Signature, beside_faults
from calib.diagnosis.simulation.response import Responder
from calib.forward.code_fault import CodeFault
from calib.forward.departure import Variable

INNER_RANGE = log(100.0)
"""Inner parameters are as likely at every logarithm within two decades."""


@dataclass(frozen=True)
class Contest:
    """What competes, and for what.

    Attributes:
        signatures: Of all effects.
        evidence: What they are to explain.
        responder: Takes signatures anew.
        free: Variables whose laws are left free where that is worth its price.
        known: What was found already, also with other laws free.
    """

    signatures: tuple[Signature, ...]
    evidence: Evidence
    responder: Responder
    free: frozenset[Variable] = frozenset()
    known: KnownFits = field(default_factory=KnownFits, compare=False)

    @cached_property
    def shapes(self) -> dict[str, int]:
        """How many shapes of each effect are tried, by name."""
        names = [each.shape.name for each in self.signatures]
        return {name: names.count(name) for name in names}

    def ranking(self, model: Model, k: int | None = None, *, worth: float = 0.0) -> list[Score]:
        """Return what each name explains of what `model` leaves, the best first.

        Args:
            model: Whose other members keep what they explain; their names do not compete.
            k: A member whose place is looked at: what it explains is to be explained, too.
            worth: The best of them are looked at closely where they explain more than this.
        """
        ranked = self.known.ranked(model, k, "as they are", lambda: self._scored(model, k))
        if ranked and ranked[0].net > worth:
            linear = ranked
            ranked = self.known.ranked(model, k, "sharp", lambda: self._sharp(linear, model, k))
        freed = self._freed(best_by_name(ranked), model, k)
        others = [m for j, m in enumerate(model.members) if j != k]
        freed = [replace(s, net=s.net - told_twice(s.signature.shape, others)) for s in freed]
        return sorted(freed, key=lambda score: -score.net)

    def _scored(self, model: Model, k: int | None) -> list[Score]:
        """Return what each shape explains, as its signature was taken first."""
        named = {m.signature.shape.name for m in model.members}
        others = [s for s in self.signatures if s.shape.name not in named]
        left = self._beside_codes(others, model, k)
        return scores(left, self._left(model, k), self._of_others(model, k), self.evidence)

    def _beside_codes(
        self, left: Sequence[Signature], model: Model, k: int | None
    ) -> Sequence[Signature]:
        """Return signatures of errors of codes beside those that the other members are."""
        left = beside_faults(left, _faults(model, k), self.evidence, self.responder)
        others = tuple(m.effect for j, m in enumerate(model.members) if j != k)
        if not others:
            return left
        told = change_of(others, self.evidence, self.responder).codes[0]
        return with_code_credit(left, self.evidence, told) if told.any() else left

    def _sharp(self, ranked: Sequence[Score], model: Model, k: int | None) -> list[Score]:
        """Return the same with the best of the signatures taken anew."""
        sharper = sharpened(ranked, self.evidence, self.responder)
        again = scores(sharper, self._left(model, k), self._of_others(model, k), self.evidence)
        return [replace(s, net=s.gain - self.price_of_shape(s.signature.shape)) for s in again]

    def _freed(self, ranked: Sequence[Score], model: Model, k: int | None) -> list[Score]:
        """Return what is ranked, laws left free where they may be and that is worth its price."""
        residual = self._left(model, k)
        basis = orthonormal(self._of_others(model, k), self.evidence)

        def freed(score: Score) -> Score:
            free = open_variable(score.signature) in self.free
            parts = (residual, basis, self.evidence)
            return self.known.freed(
                model, k, score, free=free, made=lambda: with_free_law(score, *parts)
            )

        return [freed(score) for score in ranked]

    def _left(self, model: Model, k: int | None) -> Point:
        """Return what is to be explained in the place of member `k`."""
        return model.residual if k is None else model.residual + contribution(model.members[k])

    def placed(self, model: Model, k: int | None, score: Score) -> Model:
        """Return the model with one effect more, or with it in the place of `k`, refitted."""
        return self.known.placed(model, k, score, lambda: self._fitted(model, k, score))

    def _fitted(self, model: Model, k: int | None, score: Score) -> Model:
        members = list(model.members)
        members[slice(len(members), None) if k is None else slice(k, k + 1)] = [unfitted(score)]
        return self.refitted(model, members)

    def refitted(self, model: Model, members: Sequence[Member]) -> Model:
        """Return the model with those members, all fitted anew."""
        if not members:
            return replace(
                model, members=(), change=None, residual=model.first, baseline=model.started
            )
        return refitted(replace(model, members=tuple(members)), self.evidence, self.responder)

    def own_gain(self, model: Model, k: int) -> float:
        """Return the deviance that member `k` explains beside the others, linearly."""
        others = self._of_others(model, k)
        own = contribution(model.members[k])
        rest = without(own, orthonormal(others, self.evidence), self.evidence)
        residual = model.residual + own
        product = self.evidence.product
        return 2.0 * product(rest, residual) - product(rest, rest)

    def _of_others(self, model: Model, k: int | None) -> list[Point]:
        """Return the directions in which the other members can adapt."""
        others = [m for j, m in enumerate(model.members) if j != k]
        return [d for m in others for d in (*m.directions, *(point for _, point in m.course))]

    def penalised(self, model: Model) -> float:
        """Return what a model leaves, and what its members cost."""
        prices = sum(self.price_beside(model, k) for k in range(len(model.members)))
        shared = sum(_told_twice_by(model, k) for k in range(len(model.members)))
        # What two are credited with is taken from each, and given once.
        return misfit(model, self.evidence) + prices - 0.5 * shared

    def price_beside(self, model: Model, k: int) -> float:
        """Return the price of member `k` beside the others."""
        return self.price_of(model.members[k]) + _told_twice_by(model, k)

    def price_of_shape(self, shape: Shape) -> float:
        """Return the price, in deviance, of having tried all shapes of a name, and fitted this."""
        return 2.0 * log(max(self.shapes.get(shape.name, 1), 1)) + shape.cost

    def price_of(self, member: Member) -> float:
        """Return the price of a fitted member.

        A parameter that the data determine to s of its logarithm, of a range W that it might have
        lain in, costs 2 ln(W / (s sqrt(2 pi))): Laplace's evidence.
        """
        freedom = (
            2.0 * log(INNER_RANGE / (max(std, 1e-6) * sqrt(2.0 * pi))) for std in member.std[1:]
        )
        price = self.price_of_shape(member.signature.shape) + PRICE * len(member.course)
        return price + sum(max(f, 0.0) for f in freedom)


def _faults(model: Model, k: int | None) -> tuple[CodeFault, ...]:
    """Return the faults of codes that a model has beside member `k`."""
    others = (m.effect for j, m in enumerate(model.members) if j != k)
    return tuple(effect for effect in others if isinstance(effect, CodeFault))


def told_twice(shape: Shape, others: Sequence[Member]) -> float:
    """Return what a shape is credited with and one of `others` is as well."""
    shared = dict(shape.shared)
    return max((shared.get(m.signature.shape.name, 0.0) for m in others), default=0.0)


def _told_twice_by(model: Model, k: int) -> float:
    others = [m for j, m in enumerate(model.members) if j != k]
    return told_twice(model.members[k].signature.shape, others)
