"""Examinations of small recordings, each made once for all tests of a process."""

from functools import cache

from calib.diagnosis.diagnose import Examination, examine
from calib.forward.effect import Effect
from calib.forward.model import Model
from tests.calib.diagnosis.recordings import plain_model, plan, recorded
from tests.draws import shared

COLUMNS = 96


def small_model() -> Model:
    """Return the sensor of these recordings."""
    return plain_model(COLUMNS)


@cache
def examined(effects: tuple[Effect, ...] = (), run: int = 0) -> Examination:
    """Return one examination for all tests that look at it; another of chance for each `run`."""
    rng = shared(f"examination {run} of {effects}")
    evidence = recorded(small_model(), plan(rng, 120, twice=2), rng, effects)
    return examine(evidence, None if effects else small_model())
