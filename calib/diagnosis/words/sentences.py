"""One sentence for every effect of the catalogue: what happens, how much of it, its name."""

from calib.diagnosis.words.charge import CHARGE
from calib.diagnosis.words.light import LIGHT
from calib.diagnosis.words.readout import READOUT
from calib.diagnosis.words.telling import Telling

SENTENCES = {**LIGHT, **CHARGE, **READOUT}
"""By the effect's name."""


def sentence_of(told: Telling) -> str:
    """Return what an operator is told of an effect: what happens, how much of it, its name."""
    return SENTENCES[told.effect.name](told)
