"""What a contest has found already: the same names at the same place of the same model.

A search with free laws repeats what the one without did until the first law is freed, an exchange
that changed nothing ends where the next begins, and what a finding may be called is asked where the
search has asked it.
"""

from collections.abc import Callable, Sequence

from calib.diagnosis.evidence.point import Point
from calib.diagnosis.naming.model import Member, Model
from calib.diagnosis.naming.scores import Score
from calib.diagnosis.simulation.latest import Itself, Latest
from calib.diagnosis.statistics.change import Change

MOST_BYTES = 1 << 28
"""Of models that are kept."""
MOST_RANKINGS = 24
"""That are kept: each may hold signatures of its own, of codes beside faults."""
MOST_SCORES = 256
"""With a law left free, that are kept."""


class KnownFits:
    """The latest rankings and models, by the very objects that they follow from."""

    def __init__(self) -> None:
        """Know nothing."""
        self._rankings: Latest[list[Score]] = Latest(lambda _: 1, MOST_RANKINGS)
        self._freed: Latest[Score] = Latest(lambda _: 1, MOST_SCORES)
        self._models: Latest[Model] = Latest(_size, MOST_BYTES)

    def ranked(
        self, model: Model, k: int | None, mark: str, made: Callable[[], list[Score]]
    ) -> list[Score]:
        """Return a ranking of what may stand in the place of member `k`, made where not known."""
        return self._rankings.of((Itself(model), k, mark), made)

    def freed(
        self, model: Model, k: int | None, score: Score, *, free: bool, made: Callable[[], Score]
    ) -> Score:
        """Return a score there with its law left free if it may be, likewise."""
        return self._freed.of((Itself(model), k, Itself(score)), made) if free else score

    def placed(self, model: Model, k: int | None, score: Score, made: Callable[[], Model]) -> Model:
        """Return the model with a name in the place of member `k`, likewise."""
        course = tuple(Itself(point) for _, point in score.course)
        key = (Itself(model), k, Itself(score.signature), score.amplitude, course)
        return self._models.of(key, made)


def _size(model: Model) -> int:
    change = 0 if model.change is None else model.change.nbytes
    return model.residual.nbytes + change + sum(map(_of_member, model.members))


def _of_member(member: Member) -> int:
    own = list(zip(member.changes, member.directions, strict=True))
    return _of_parts(own) + _of_parts(member.course)


def _of_parts(parts: Sequence[tuple[Change, Point]]) -> int:
    return sum(change.nbytes + point.nbytes for change, point in parts)
