"""What a remainder without a name looks like: a pattern over the pixels times a course over blocks.

The whitened means that no effect explains are taken apart by singular values. The first pattern is
compared with what patterns there are (taps, a smooth shape along the columns, single columns), its
course over the blocks with each variable of the plan; what follows none is said to follow none.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.polynomial.legendre import legvander
from numpy.typing import NDArray

from calib.diagnosis.answer.finding import Where
from calib.diagnosis.answer.locate import columns_of, where
from calib.diagnosis.answer.rhythm import rhythm_of
from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.naming.look import Look
from calib.diagnosis.naming.model import Model

Floats = NDArray[np.float64]

FOLLOWS = 0.6
"""Of a course's or a pattern's variance, beyond what chance fits, from which on it follows one."""
SMOOTH_DEGREE = 4
FEW_SHARE = 0.02
"""A pattern that has most of its energy in so few pixels is one of single pixels."""
_VARIABLES = {
    "signal": "the signal",
    "exposure": "the exposure time",
    "level": "the level",
    "time": "wall time",
    "temperature": "the temperature",
    "previous_block": "the signal of the block before",
}


@dataclass(frozen=True)
class Pattern:
    """An empirical term: a pattern over the pixels times a course over the blocks, whitened.

    Attributes:
        course: Its size in each block, (n_blocks,).
        pixels: Of unit length, (n_pixels,).
        share: Of the squared remainder beyond chance that it explains.
    """

    course: Floats
    pixels: Floats
    share: float


def describe(look: Look, model: Model, evidence: Evidence) -> Where:
    """Return where a remainder lives and what it follows, in words, too."""
    columns = (0, evidence.sensor.n_columns - 1)
    place = where(look.statistic, look.depends_on, look.blocks, columns, evidence)
    if look.statistic == "spectrum":
        return replace(place, text=place.text + rhythm_of(evidence))
    if look.statistic != "mean" or evidence.n_blocks < SMOOTH_DEGREE:
        return place
    pattern = first_pattern(model.residual.means, evidence)
    variable, follows = followed(pattern, evidence)
    text = f" One pattern, {shape_of(pattern.pixels, evidence)}, makes {pattern.share:.0%} of it; "
    if variable is None:
        text += "from block to block it follows no variable of the plan."
    else:
        text += f"from block to block it follows {_VARIABLES[variable]} ({follows:.0%} of it)."
    depends = (variable,) if variable is not None else look.depends_on
    columns = columns_of(pattern.pixels**2, evidence)
    return replace(place, depends_on=depends, columns=columns, text=place.text + text)


def first_pattern(means: Floats, evidence: Evidence) -> Pattern:
    """Return the strongest pattern of whitened means, (n_blocks, n_pixels)."""
    left, values, right = np.linalg.svd(means, full_matrices=False)
    excess = float((means**2).sum()) - evidence.space.degrees_of_freedom
    # The largest of chance's own: (sqrt(n_blocks) + sqrt(n_pixels))^2, Marchenko and Pastur (1967).
    chance = (np.sqrt(means.shape[0]) + np.sqrt(means.shape[1])) ** 2
    share = (float(values[0]) ** 2 - chance) / max(excess, 1e-300)
    return Pattern(left[:, 0] * values[0], right[0], float(np.clip(share, 0.0, 1.0)))


def followed(pattern: Pattern, evidence: Evidence) -> tuple[str | None, float]:
    """Return the variable that a course follows best, and how far; None where it follows none."""
    table, signal = evidence.table, evidence.signal_dn
    variables = {
        "signal": signal,
        "exposure": table.exposure_us,
        "level": table.level,
        "time": table.mid_s,
        "temperature": table.temperature_c,
        "previous_block": np.concatenate([signal[:1], signal[:-1]]),
    }
    shares = {name: _explained(pattern, x, evidence) for name, x in variables.items()}
    best = max(shares, key=lambda name: shares[name])
    return (best, shares[best]) if shares[best] > FOLLOWS else (None, shares[best])


def shape_of(pixels: Floats, evidence: Evidence) -> str:
    """Return what a pattern looks like, in words."""
    sensor = evidence.sensor
    tap = sensor.tap.ravel()
    if sensor.n_taps > 1:
        levels = np.array([pixels[tap == t].mean() for t in range(sensor.n_taps)])
        if np.ptp(levels) > 0 and 1.0 - (pixels - levels[tap]).var() / pixels.var() > FOLLOWS:
            return "one level for each tap"
    column = np.tile(np.linspace(-1.0, 1.0, sensor.n_columns), sensor.n_rows)
    design = legvander(column, SMOOTH_DEGREE)
    left = pixels - design @ np.linalg.lstsq(design, pixels, rcond=None)[0]
    if 1.0 - float(left @ left) > FOLLOWS:
        alike = pixels.mean() ** 2 * len(pixels)
        return "the same in all columns" if alike > FOLLOWS else "smooth along the columns"
    few = max(1, round(FEW_SHARE * len(pixels)))
    if float(np.sort(pixels**2)[-few:].sum()) > FOLLOWS:
        return "in a few single columns"
    return "irregular along the columns"


def _explained(pattern: Pattern, variable: Floats, evidence: Evidence) -> float:
    """Return the share of a course that parabolas explain, freedom counted.

    They scale the pattern itself, or the signal that it has: of both the baseline's offsets and
    slopes have taken their part, as of the course.
    """
    if np.ptp(variable) <= 0:
        return 0.0
    x = 2.0 * (variable - variable.min()) / np.ptp(variable) - 1.0
    signal = evidence.signal_dn / max(float(evidence.signal_dn.max()), 1e-300)
    powers = [power * size for power in legvander(x, 2)[:, 1:].T for size in (1.0 + 0 * x, signal)]
    weight = evidence.space.weight
    dn = pattern.pixels / np.maximum(weight.mean(axis=0), 1e-300)
    design = np.stack([evidence.space.project(np.outer(p, dn)) @ pattern.pixels for p in powers], 1)
    found, _, rank, _ = np.linalg.lstsq(design, pattern.course, rcond=1e-3)
    left = pattern.course - design @ found
    free = max(len(x) - len(evidence.space.basis), 1)
    chance = float(left @ left) / max(free - int(rank), 1)
    return 1.0 - chance / max(float(pattern.course @ pattern.course) / free, 1e-300)
