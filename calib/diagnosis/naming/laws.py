"""Laws that no shape of an effect has: other functions of the variable that it follows.

What an effect is called does not hang on its formula's last term: a drift may take any course,
lamps lose by any rule of how many burn, a converter errs by any function of the code. Each effect
says which variable its physics leaves open (`Departure.any_law`, `smooth_law`); how it depends on
all others, and what it does to noise, stays what it is, and tells it from other effects.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.polynomial.legendre import legvander
from numpy.typing import NDArray
from scipy.special import ndtr

from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.naming.signatures import Signature
from calib.diagnosis.statistics.change import Change
from calib.diagnosis.statistics.counts import grouped
from calib.forward.departure import Variable
from calib.forward.effect import Stage

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
KNOTS = 14
"""Of a function of the code: as many straight pieces, and one more."""
BENDS = (3, 4, 5)
"""Powers of the signal besides those of the plainest bend."""


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
    if variable in {"signal", "code", "column", "line"}:
        own = replace(change * 0.0, means=change.means)
        # A border moves the flux of both its pixels or of one more than of the other: profiles
        # lose up to twice as much for the same covariances.
        profiles = (own,) if effect.stage is Stage.CHARGE else ()
        tied = change - own if profiles else change
        parts = (*_OF_PIXELS[variable, smooth](tied, evidence), *profiles)
        return Laws(parts, np.eye(len(parts)), len(parts))
    values, place = np.unique(
        _of_blocks(str(variable), evidence, smooth=smooth), return_inverse=True
    )
    alone = tuple(_scaled(change, (place == k).astype(float)) for k in range(len(values)))
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


def _bends(like: Change, evidence: Evidence) -> Iterator[Change]:
    """Yield powers of each pixel's signal."""
    signal = np.maximum(evidence.baseline.mean_dn - evidence.baseline.offset_dn, 0.0)
    top = max(float(signal.max()), 1e-300)
    for power in BENDS:
        share = signal / top
        yield _bent(like, evidence, top * share**power, power * share ** (power - 1))


def _corners(like: Change, evidence: Evidence) -> Iterator[Change]:
    """Yield straight pieces of each pixel's code: with all of them, any function of it."""
    mean = evidence.baseline.mean_dn
    std = np.sqrt(evidence.baseline.variance_dn2)
    for knot in np.linspace(mean.min(), mean.max(), KNOTS + 2)[1:-1]:
        # A corner is rounded by each pixel's noise: the mean of max(0, DN - knot).
        z = (mean - knot) / std
        above = np.asarray(ndtr(z))
        density = np.exp(-0.5 * z**2) / np.sqrt(2.0 * np.pi)
        yield _bent(like, evidence, std * (z * above + density), above)


def _bent(like: Change, evidence: Evidence, added: Floats, slope: Floats) -> Change:
    """Return the change where `added`, DN, moves means, and its slope stretches their noise."""
    where = evidence.pooled.places["variance"]
    pooled = np.zeros_like(like.pooled)
    variance, some = evidence.baseline.variance_dn2, np.maximum(evidence.counts.pixels, 1.0)
    for b, stretched in enumerate(2.0 * slope * variance):
        pooled[b, where] = grouped(stretched, evidence.sensor) / some
    return replace(like * 0.0, means=added.reshape(like.means.shape), pooled=pooled)


def _farther(like: Change, evidence: Evidence) -> Iterator[Change]:
    """Yield what columns two apart exchange as nearest ones do, and what scenes show of pairs."""
    pooled, places = np.zeros_like(like.pooled), evidence.pooled.places
    pooled[:, places["columns_2"]] = like.pooled[:, places["columns_1"]]
    sensor = evidence.sensor
    gained = like.means.reshape(-1, sensor.n_rows, sensor.n_columns)
    over = np.cumsum(gained, axis=-1)[..., :-1]
    two = over[..., 1:] + over[..., :-1]
    yield replace(_over_borders(two, 2, like, evidence), pooled=pooled)
    every_other = np.where(np.arange(over.shape[-1]) % 2 == 1, 1.0, -1.0)
    yield _over_borders(over * every_other, 1, like, evidence)


def _over_borders(over: Floats, distance: int, like: Change, evidence: Evidence) -> Change:
    """Return the change where so much, DN, comes to columns from those at a distance on."""
    gained = np.zeros((len(over), evidence.sensor.n_rows, evidence.sensor.n_columns))
    gained[..., :-distance] += over
    gained[..., distance:] -= over
    return replace(like * 0.0, means=gained.reshape(like.means.shape))


def _later(like: Change, evidence: Evidence) -> Iterator[Change]:
    """Yield what lines one and two apart have in common, as each line's own pixels do."""
    shared = like.pooled[:, evidence.pooled.places["common"]].mean(axis=1, keepdims=True)
    for kind in ("common_1", "common_2"):
        pooled = np.zeros_like(like.pooled)
        pooled[:, evidence.pooled.places[kind]] = shared
        yield replace(like * 0.0, pooled=pooled)


def _scaled(change: Change, by_block: Floats) -> Change:
    """Return the change of means and pooled statistics, each block's times a factor."""
    return replace(
        change * 0.0,
        means=change.means * by_block[:, None],
        pooled=change.pooled * by_block[:, None],
        monitor=change.monitor * by_block,
    )


_OF_PIXELS: Mapping[tuple[Variable, bool], Callable[[Change, Evidence], Iterator[Change]]] = {
    ("signal", True): _bends,
    ("code", False): _corners,
    ("column", False): _farther,
    ("line", False): _later,
}
"""By the variable that an effect's law leaves open, and whether it is to be smooth."""
