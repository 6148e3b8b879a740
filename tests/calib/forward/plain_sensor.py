"""A sensor whose codes are its electrons and 100: what effects do to charge is seen as it is."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from calib.forward.effect import Effect
from calib.forward.model import Model
from calib.recording.header import Block

OFFSET_DN = 100.0
PERIOD_US = 100.0
ELECTRONS_PER_LAMP = 500.0
COLUMNS = 2000

TEXT = """
[camera]
columns = {columns}
bit_depth = 16
line_period_us = 100.0
{more}

[source]
kind = "sphere"
lamps = 4

[effects.illumination]
radiance = [10.0, 10.0, 10.0, 10.0]

[effects.responsivity]
electrons_per_radiance_us = 1.0
prnu_std = 0.0

[effects.shot_noise]

[effects.system_gain]
dn_per_e = 1.0

[effects.offset]
mean_dn = 100.0
pattern_std_dn = 0.0

[effects.adc]
bit_depth = 16
"""


def plain(*effects: Effect, columns: int = COLUMNS, more: str = "") -> Model:
    """500 electrons per lamp at 50 us, 1 DN each, no noise but shot noise."""
    model = Model.loads(TEXT.format(columns=columns, more=more))
    for effect in effects:
        model = model.with_effect(effect)
    return model


def block(name: str, level: float, **given: Any) -> Block:
    """A flat at 50 us, or a dark where the level is 0."""
    kind = "flat" if level else "dark"
    return Block(block=name, kind=kind, exposure_us=50.0, level=level, **given)


def covariance(a: NDArray[np.float64], b: NDArray[np.float64]) -> float:
    """The covariance of two arrays' elements about their own column means, over the lines."""
    return float(np.mean((a - a.mean(0)) * (b - b.mean(0))) * len(a) / (len(a) - 1))


def score(found: float, wanted: float, standard_error: float) -> float:
    return abs(found - wanted) / standard_error
