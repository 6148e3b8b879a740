"""Laws of what differs from pixel to pixel: of its signal, code, column, line, or tap."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace

import numpy as np
from numpy.polynomial.legendre import legvander
from numpy.typing import NDArray
from scipy.special import ndtr

from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.statistics.change import Change
from calib.diagnosis.statistics.counts import grouped
from calib.forward.departure import Variable
from calib.forward.effect import Stage

Floats = NDArray[np.float64]

KNOTS = 14
"""Of a function of the code: as many straight pieces, and one more."""
BENDS = (3, 4, 5)
"""Powers of the signal besides those of the plainest bend."""
TOES = (0.1, 0.3)
"""Of the largest signal, over which a bend at the bottom of the range fades."""
BARRIERS = (0.2, 0.4, 0.6)
"""Of the largest signal, above which alone charge may stay for the next line."""
TRAPS_FILLED = (0.1, 0.3, 1.0)
"""Of the largest signal, which fills half of the traps that hold charge for the next line."""
PROFILE_DEGREE = 5
"""Of light over the columns: what falls by e over a fifth of them is followed to 0.3 % of its
largest."""

GRADIENT_DEGREE = 2
"""Of dark current over the columns: one end is warmer, or the middle. What is steeper glows."""


def laws_of_pixels(
    change: Change, evidence: Evidence, variable: Variable, stage: Stage, *, smooth: bool
) -> tuple[Change, ...]:
    """Return the changes by which an effect may differ from its shape's.

    Args:
        change: The shape's.
        evidence: The recording.
        variable: What the law is of: signal, code, column, line, or tap.
        stage: At which the effect acts.
        smooth: Whether the law is to be smooth.
    """
    if variable == "column" and smooth:
        return tuple(_profiles(change, evidence, stage))
    of = _OF_PIXELS[variable, smooth]
    if stage is not Stage.CHARGE:
        return tuple(of(change, evidence))
    # A border moves the flux of both its pixels or of one more than of the other: profiles
    # lose up to twice as much for the same covariances, two columns on, too.
    own = replace(change * 0.0, means=change.means)
    return (*of(change - own, evidence), next(of(own, evidence)), own)


def _profiles(like: Change, evidence: Evidence, stage: Stage) -> Iterator[Change]:
    """Yield the change times polynomials of the column, whose mean over them is 0."""
    sensor = evidence.sensor
    degree = GRADIENT_DEGREE if stage is Stage.CHARGE else PROFILE_DEGREE
    along = legvander(np.linspace(-1.0, 1.0, sensor.n_columns), degree)[:, 1:].T
    for profile in along - along.mean(axis=1, keepdims=True):
        yield _over_pixels(like, evidence, np.tile(profile, sensor.n_rows))


def _over_pixels(like: Change, evidence: Evidence, profile: Floats) -> Change:
    """Return the change of means and variances times a factor for each pixel, (n_pixels,)."""
    sensor, where = evidence.sensor, evidence.pooled.places["variance"]
    over = profile.reshape(1, sensor.n_rows, sensor.n_columns)
    pooled = np.zeros_like(like.pooled)
    some = np.maximum(evidence.counts.pixels, 1.0)
    pooled[:, where] = like.pooled[:, where] * (grouped(over, sensor)[0] / some)
    return replace(like * 0.0, means=like.means * profile, pooled=pooled)


def _bends(like: Change, evidence: Evidence) -> Iterator[Change]:
    """Yield powers of each pixel's signal, and bends that fade as it grows."""
    signal = np.maximum(evidence.baseline.mean_dn - evidence.baseline.offset_dn, 0.0)
    top = max(float(signal.max()), 1e-300)
    share = signal / top
    for power in BENDS:
        yield _bent(like, evidence, top * share**power, power * share ** (power - 1))
    for toe in TOES:
        fading = np.exp(-share / toe)
        yield _bent(like, evidence, top * share * fading, (1.0 - share / toe) * fading)


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


def _of_taps(like: Change, evidence: Evidence) -> Iterator[Change]:
    """Yield what single taps see: one may see its partner, which does not see it."""
    sensor, places = evidence.sensor, evidence.pooled.places
    of_group = np.arange(sensor.n_groups) // (sensor.n_groups // sensor.n_taps)
    for tap in range(sensor.n_taps):
        # Of what two pixels share, each one's part is half, whoever's covariance counts it.
        pooled = like.pooled / sensor.n_taps
        pooled[:, places["variance"]] = like.pooled[:, places["variance"]] * (of_group == tap)
        means = like.means * (sensor.tap.ravel() == tap)
        yield replace(like * 0.0, means=means, pooled=pooled)


def _kept(like: Change, evidence: Evidence) -> Iterator[Change]:
    """Yield what first lines show where the charge that stays is another function of all charge.

    Of charge q, g(q) waits for the next line: after a step from q to q', g(q) - g(q') is read, and
    the mean of n lines is off by an nth of that.
    """
    signal = np.maximum(evidence.signal_dn, 0.0)
    before = np.concatenate([signal[:1], signal[:-1]])
    step = before - signal
    per_line = step / evidence.n
    of_step = step @ like.onset / max(float(step @ step), 1e-300)
    of_mean = per_line @ like.means / max(float(per_line @ per_line), 1e-300)
    top = max(float(signal.max()), 1e-300)
    share = np.stack([before, signal]) / top
    staying = [np.maximum(share - barrier, 0.0) for barrier in BARRIERS]
    staying += [share / (1.0 + share / filled) for filled in TRAPS_FILLED]
    for then, now in staying:
        kept = top * (then - now)
        means, onset = np.outer(kept / evidence.n, of_mean), np.outer(kept, of_step)
        yield replace(like * 0.0, means=means, onset=onset)


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


_OF_PIXELS: Mapping[tuple[Variable, bool], Callable[[Change, Evidence], Iterator[Change]]] = {
    ("signal", True): _bends,
    ("signal", False): _kept,
    ("code", False): _corners,
    ("column", False): _farther,
    ("line", False): _later,
    ("tap", False): _of_taps,
}
"""By the variable that an effect's law leaves open, and whether it is to be smooth."""
