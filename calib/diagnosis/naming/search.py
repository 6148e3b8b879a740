"""Looks for the catalogue's effects: adds the best, refits all, and puts names to the test.

A greedy search ends where it began. So the likeliest few names are fitted before one of them is
added, and when all are there each has to stand against what could take its place now: what looked
like one effect may be two, of which the first name was neither.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.stats import chi2

from calib.diagnosis.naming.contest import Contest
from calib.diagnosis.naming.imperfection import left_by_errors
from calib.diagnosis.naming.laws import open_variable
from calib.diagnosis.naming.model import Model
from calib.diagnosis.naming.other_course import follows_signal
from calib.diagnosis.naming.remainder import unexplained_deviance
from calib.diagnosis.naming.scores import Score
from calib.diagnosis.naming.support import supported
from calib.diagnosis.shapes.of_effects import departures
from calib.forward.departure import Variable

FALSE_ALARMS = 0.02
"""Of recordings in which nothing is hidden: in so many at most chance reaches the threshold."""
THRESHOLD = float(chi2.isf(FALSE_ALARMS / len(departures()), 1))
"""Deviance, after its price, by which a name of the catalogue is told from chance: 11.8 for 33.

What chance explains along one direction is the square of a normal number, and each name may be the
one that passes (Bonferroni). The best of n shapes, which pays 2 ln n, passes no oftener than one
alone would; where shapes are alike, and strengths have one sign, alarms are rarer than that.
"""
BESIDE = 16.0
"""The same of a name beside others: a story of two is dearer than one of a law with a free function
(`PRICE`, 12), and what strong effects leave is no chance alone."""
MOST_EFFECTS = 4
SETTINGS: frozenset[Variable] = frozenset(
    {"level", "exposure", "temperature", "signal", "code", "column", "line", "tap"}
)
"""Variables of which laws are left free first: a course in time comes near all of them."""
COURSES: frozenset[Variable] = frozenset({"time"})
CLOSE = 25.0
"""Names within so much deviance of the best one may be better once they are fitted."""
CLOSE_SHARE = 0.15
"""So may those within this share of what the best one explains: shapes are that coarse."""
MOST_FITTED = 2
"""So many names are fitted for one place."""
ROUNDS = 2
"""Of exchanges."""
BETTER = 4.0
"""Deviance by which a name has to be better than one that has the place."""


def find(contest: Contest, nothing: Model) -> Model:
    """Return the effects that explain the recording better than chance, jointly fitted.

    Where one shape of the catalogue does not explain all, laws are left free (see `laws`) in a
    search of its own: one name whose law is free may be simpler than several names.

    Args:
        contest: What is looked for.
        nothing: The model in which nothing has been found yet.
    """
    model = _searched(contest, nothing)
    for free in (SETTINGS, SETTINGS | COURSES):
        opened = replace(contest, free=free)
        left = unexplained_deviance(model, contest.evidence)
        if len(model.members) <= 1 and left == 0.0 and not _outdone(model, opened, nothing):
            break
        freed = _searched(opened, nothing)
        told = [m for m in (freed, _shaped(freed, contest)) if _is_told(m, contest)]
        model = min((model, *told), key=lambda m: _cost(m, contest))
    return supported(model, contest)


def _outdone(model: Model, opened: Contest, nothing: Model) -> bool:
    """Return whether another name, its law left free, explains more than the one that was found.

    What a name leaves may be little enough to be excused, and still more than another would leave.
    """
    if not model.members:
        return False
    worth = opened.penalised(nothing) - opened.penalised(model) + CLOSE
    best = opened.ranking(nothing, worth=worth)[0]
    return best.net > worth and best.name != model.members[0].signature.shape.name


def _is_told(model: Model, contest: Contest) -> bool:
    """Return whether a model may stand: a law that may be any has no excuse for remainders.

    Nor has it one for a course in time that is the signal's.
    """
    if not any(m.course for m in model.members):
        return True
    if unexplained_deviance(model, contest.evidence) > 0.0:
        return False
    members = range(len(model.members))
    return not any(follows_signal(k, model, contest.evidence) for k in members)


def _shaped(freed: Model, contest: Contest) -> Model:
    """Return the names of `freed` with the catalogue's courses, whose times are fitted then.

    A course that is free fits what a time constant would, and no amended model can carry it.
    """
    if not any(m.course for m in freed.members):
        return freed
    return contest.refitted(freed, [replace(m, course=(), course_fit=()) for m in freed.members])


def as_found(contest: Contest, model: Model) -> Contest:
    """Return the contest with those laws left free that the model has taken."""
    taken = (open_variable(m.signature) for m in model.members if m.course)
    return replace(contest, free=frozenset(variable for variable in taken if variable))


def _cost(model: Model, contest: Contest) -> float:
    names = range(1, len(model.members) + 1)
    return contest.penalised(model) + sum(_asked(n) for n in names)


def _asked(n: int) -> float:
    """Return the deviance that the `n`-th name of a story has to explain."""
    return THRESHOLD if n == 1 else BESIDE


def _searched(contest: Contest, nothing: Model) -> Model:
    """Return the effects that are found one after the other, each put to the test at the end."""
    model, tested = nothing, False
    while True:
        ranked = _beyond_errors(contest.ranking(model, worth=THRESHOLD / 2), model, contest)
        if len(model.members) >= MOST_EFFECTS or not ranked:
            settled = _pruned(_exchanged(model, contest), contest)
            if settled is model or tested:
                return settled
            model, tested = settled, True
            continue
        grown = _pruned(_best_placed(model, None, ranked, contest), contest)
        if contest.penalised(grown) > contest.penalised(model) - _asked(len(model.members) + 1):
            return model
        model = grown


def _beyond_errors(ranked: Sequence[Score], model: Model, contest: Contest) -> list[Score]:
    """Return names that explain more than chance, and than errors of the effects found leave."""
    return [
        score
        for score in ranked
        if score.net > _asked(len(model.members) + 1)
        and score.net > left_by_errors(score.signature.point, model, contest.evidence)
    ]


def _best_placed(model: Model, k: int | None, ranked: Sequence[Score], contest: Contest) -> Model:
    """Return the model with the best of the likeliest names in its place, each of them fitted."""
    least = ranked[0].net - CLOSE - CLOSE_SHARE * ranked[0].net
    close = [s for s in ranked[:MOST_FITTED] if s.net > max(least, THRESHOLD)] or ranked[:1]
    return min((contest.placed(model, k, score) for score in close), key=contest.penalised)


def _exchanged(model: Model, contest: Contest) -> Model:
    """Return the model with names exchanged for such as explain more beside the others."""
    for _ in range(ROUNDS):
        trials = [model]
        for k in range(len(model.members)):
            own = contest.own_gain(model, k)
            worth = max(own - CLOSE - CLOSE_SHARE * own, THRESHOLD)
            ranked = contest.ranking(model, k, worth=worth)
            if ranked and ranked[0].net > worth:
                trials.append(_best_placed(model, k, ranked, contest))
        best = min(trials, key=contest.penalised)
        if contest.penalised(best) > contest.penalised(model) - BETTER:
            return model
        model = best
    return model


def _pruned(model: Model, contest: Contest) -> Model:
    """Return the model without effects that explain no more than chance beside the others."""
    if not model.members:
        return model
    gains = [contest.own_gain(model, k) for k in range(len(model.members))]
    least = int(np.argmin(gains))
    if gains[least] - contest.price_beside(model, least) > _asked(len(model.members)):
        return model
    kept = [m for j, m in enumerate(model.members) if j != least]
    return _pruned(contest.refitted(model, kept), contest)
