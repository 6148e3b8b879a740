"""Laws that no shape of an effect has: other functions of the variable that it follows.

What an effect is called does not hang on its formula's last term: a drift may take any course,
lamps lose by any rule of how many burn, a converter errs by any function of the code. Each effect
says which variable its physics leaves open (`Departure.any_law`, `smooth_law`); how it depends on
all others, and what it does to noise, stays what it is, and tells it from other effects.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.polynomial.legendre import legvander
from numpy.typing import NDArray

from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.naming.pixel_laws import laws_of_pixels
from calib.diagnosis.signatures.signature import Signature
from calib.diagnosis.statistics.change import Change
from calib.forward.departure import Variable

Floats = NDArray[np.float64]

DEGREE = 5
"""Of a course in time: it comes and goes twice."""
SMOOTH_DEGREE = 2
"""Of laws of any other variable, beside the shape itself."""
TURNS = np.arange(0.5, 4.1, 0.5)
"""Of a course in time that swings."""
MOST = 4
"""Functions of a block's conditions that are added, half as many as it has values at most: what
takes more is no law."""


def open_variable(signature: Signature) -> Variable | None:
    """Return the variable that an effect may follow by another law; None where it may not."""
    effect = signature.shape.template
    return effect.any_law or effect.smooth_law


def leaves_parameters(signature: Signature) -> bool:
    """Return whether other parameters mean what they did where a law is free; a time has none."""
    return open_variable(signature) == "column"


@dataclass(frozen=True)
class Laws:
    """The functions by which an effect may differ from its shape.

    Attributes:
        parts: Changes.
        functions: Sums of them that are tried, (n_functions, n_parts).
        most: How many of them together are still a law.
    """

    parts: tuple[Change, ...]
    functions: Floats
    most: int


def laws(signature: Signature, evidence: Evidence) -> Laws:
    """Return the laws of an effect that has an `open_variable`."""
    effect, change = signature.shape.template, signature.change
    variable, smooth = open_variable(signature), effect.any_law is None
    if variable in {"signal", "code", "column", "line", "tap"}:
        parts = laws_of_pixels(change, evidence, variable, effect.stage, smooth=smooth)
        return Laws(parts, np.eye(len(parts)), len(parts))
    values, place = np.unique(
        _of_blocks(str(variable), evidence, smooth=smooth), return_inverse=True
    )
    alone = tuple(scaled(change, (place == k).astype(float)) for k in range(len(values)))
    most = min(MOST, max(len(values) // 2, 1))
    return Laws(alone, functions(values, course=variable == "time", smooth=smooth), most)


def _of_blocks(variable: str, evidence: Evidence, *, smooth: bool) -> Floats:
    """Return a variable of the plan, (n_blocks,); as a smooth law has it, on its natural scale."""
    table = evidence.table
    level = np.maximum(table.level, table.level[~table.dark].min(initial=np.inf))
    values: dict[str, Floats] = {
        "time": table.mid_s,
        "level": np.log(level) if smooth else level,
        "exposure": np.log(table.exposure_us),
        "temperature": table.temperature_c,
    }
    return values[variable]


def functions(values: Floats, *, course: bool, smooth: bool) -> Floats:
    """Return functions of `values`, (n_values,) and increasing, as (n_functions, n_values)."""
    if len(values) < 2:
        return np.zeros((0, len(values)))
    x = (values - values[0]) / np.ptp(values)
    degree = min(DEGREE if course else SMOOTH_DEGREE, len(values) - 1)
    found = [legvander(2.0 * x - 1.0, degree)[:, 1:].T]
    if smooth:
        found.append(np.maximum(x - _onsets(x)[:, None], 0.0))
    else:
        found.append(np.where(x > x[:-1, None], 1.0, -1.0))
    if course:
        angle = 2.0 * np.pi * TURNS[:, None] * x
        found += [np.sin(angle), np.cos(angle)]
    return np.concatenate(found)


def _onsets(x: Floats) -> Floats:
    """Return three places where a law may set in, among values of 0 ... 1."""
    return np.asarray(np.quantile(x, (0.25, 0.5, 0.75)))


def scaled(change: Change, by_block: Floats) -> Change:
    """Return the change of means and pooled statistics, each block's times a factor."""
    return replace(
        change * 0.0,
        means=change.means * by_block[:, None],
        pooled=change.pooled * by_block[:, None],
        monitor=change.monitor * by_block,
    )
