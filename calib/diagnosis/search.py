"""Looks for the catalogue's effects: adds the best, refits all, and puts names to the test.

A greedy search ends where it began. So the likeliest few names are fitted before one of them is
added, and after each addition every effect found before has to stand against what could take its
place now: what looked like one effect may be two, of which the first name was neither.
"""

from collections.abc import Sequence

import numpy as np

from calib.diagnosis.contest import Contest
from calib.diagnosis.model import Model
from calib.diagnosis.scores import Score
from calib.diagnosis.support import supported

THRESHOLD = 16.0
"""Deviance, after its penalty, that chance alone reaches in about two of a hundred recordings."""
MOST_EFFECTS = 4
IMPERFECT = 0.004
"""Signatures are this accurate, in deviance: what is left of a strong effect is no other one."""
CLOSE = 25.0
"""Names within so much deviance of the best one may be better once they are fitted."""
CLOSE_SHARE = 0.15
"""So may those within this share of what the best one explains: shapes are that coarse."""
MOST_FITTED = 3
"""So many names are fitted for one place."""
BETTER = 4.0
"""Deviance by which a name has to be better than one that has the place."""


def find(contest: Contest, nothing: Model) -> Model:
    """Return the effects that explain the recording better than chance, jointly fitted.

    Args:
        contest: What is looked for.
        nothing: The model in which nothing has been found yet.
    """
    model, most = nothing, 0.0
    while len(model.members) < MOST_EFFECTS:
        ranked = contest.ranking(model, worth=THRESHOLD / 2)
        if not ranked or ranked[0].net < max(THRESHOLD, IMPERFECT * most):
            break
        most = max(most, ranked[0].gain)
        grown = _pruned(_exchanged(_best_placed(model, None, ranked, contest), contest), contest)
        if contest.penalised(grown) > contest.penalised(model) - THRESHOLD:
            break
        model = grown
    return supported(model, contest)


def _best_placed(model: Model, k: int | None, ranked: Sequence[Score], contest: Contest) -> Model:
    """Return the model with the best of the likeliest names in its place, each of them fitted."""
    least = ranked[0].net - CLOSE - CLOSE_SHARE * ranked[0].net
    close = [s for s in ranked[:MOST_FITTED] if s.net > max(least, THRESHOLD)] or ranked[:1]
    return min((contest.placed(model, k, score) for score in close), key=contest.penalised)


def _exchanged(model: Model, contest: Contest) -> Model:
    """Return the model with names exchanged for such as explain more beside the others."""
    for _ in range(MOST_EFFECTS):
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
    if gains[least] - contest.price_of(model.members[least]) > THRESHOLD:
        return model
    kept = [m for j, m in enumerate(model.members) if j != least]
    return _pruned(contest.refitted(model, kept), contest)
