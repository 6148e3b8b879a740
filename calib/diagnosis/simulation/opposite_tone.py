"""The same tone half a period later: what a tone and noise have in common by chance is opposite."""

from math import pi
from typing import TypeVar

from calib.diagnosis.simulation.sampled_lines import is_tone
from calib.diagnosis.simulation.with_values import with_values
from calib.forward.effect import Effect

E = TypeVar("E", bound=Effect)


def opposite_tone(effect: E) -> E:
    """Return a tone with the opposite sign; any other effect as it is.

    A tone of amplitude a beside noise n adds a^2 / 2 to second moments, and a n to those of a few
    lines. The first is what it does, the second is chance, and far more where a is small; in the
    mean of both signs it is gone.
    """
    if not is_tone(effect):
        return effect
    phase_rad = float(getattr(effect, "phase_rad"))  # noqa: B009 - every tone has one
    return with_values(effect, {"phase_rad": phase_rad - pi if phase_rad > 0 else phase_rad + pi})
