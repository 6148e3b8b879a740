"""What a changed distribution of a pixel's codes is worth: 2 n KL(changed, plain).

The plain one may take the changed one's mean, which an offset absorbs.
"""

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np
from scipy.special import ndtr

from tests.concealed.generator.mechanism import Mechanism
from tests.concealed.generator.mechanisms.codes import AdcDnl, BlackClip, StuckBit
from tests.concealed.generator.mechanisms.collection import CosmicRays
from tests.concealed.generator.mechanisms.electronics import RtsPixels
from tests.concealed.generator.mechanisms.unlisted_volts import LinkErrors
from tests.concealed.ideal.expected import Expected
from tests.concealed.ideal.quiet import Floats

_MOST_PIXELS = 16
_REACH = 7.0
_LEAST = 1e-60
Change = Callable[[Expected, tuple[int, int], Floats, Floats], Floats]
"""Block, pixel, codes and their plain probabilities in; changed probabilities out."""


def distribution_deviance(one: Mechanism, plain: Sequence[Expected]) -> float:
    """Return it of the effects that change distributions, 0 of all others."""
    change = _change_of(one)
    if change is None:
        return 0.0
    shape = plain[0].scan.sensor.shape
    if isinstance(one, RtsPixels):
        pixels, share = [(int(p // shape[1]), int(p % shape[1])) for p in one.places], 1.0
    else:
        every = np.linspace(0, shape[0] * shape[1] - 1, _MOST_PIXELS).astype(int)
        pixels = [(int(p // shape[1]), int(p % shape[1])) for p in every]
        share = shape[0] * shape[1] / len(pixels)
    return share * sum(_pixel(block, pixel, change) for block in plain for pixel in pixels)


def _pixel(block: Expected, pixel: tuple[int, int], change: Change) -> float:
    mean, sigma = block.dn[0][pixel], np.sqrt(block.variance[0][pixel] - 1 / 12)
    codes = _codes(mean, sigma, block)
    changed = change(block, pixel, codes, _normal(codes, mean, sigma))
    moved = float((codes * changed).sum() / changed.sum())
    least = min(_kl(changed, _normal(codes, m, sigma)) for m in (mean, moved))
    return 2 * block.scan.n_samples * max(least, 0.0)


def _codes(mean: float, sigma: float, block: Expected) -> Floats:
    """Return the codes that may come: all of them where there are few."""
    top = block.scan.sensor.top_code
    if top < 4096:
        return np.arange(top + 1.0)
    low, high = max(0.0, mean - 400 * sigma), min(float(top), mean + 400 * sigma)
    return np.arange(np.floor(low), np.ceil(high) + 1)


def _normal(codes: Floats, mean: float, sigma: float) -> Floats:
    """Return the probability of each of `codes`, which count up by one; 0 far from the mean."""
    first, reach = codes[0], 2 * _REACH * sigma + 1
    low, high = (int(np.clip(at - first, 0, len(codes))) for at in (mean - reach, mean + reach))
    probability = np.zeros(len(codes))
    if high > low:
        share = (np.append(codes[low:high] - 0.5, codes[high - 1] + 0.5) - mean) / sigma
        # Above the mean from the other side, where differences keep their digits.
        upper, lower = -np.diff(ndtr(-share)), np.diff(ndtr(share))
        probability[low:high] = np.where(share[:-1] > 0, upper, lower)
    return probability


def _kl(changed: Floats, plain: Floats) -> float:
    some = changed > _LEAST
    return float((changed[some] * np.log(changed[some] / np.maximum(plain[some], _LEAST))).sum())


def _change_of(one: Mechanism) -> Change | None:
    of = _BY_NAME.get(one.name)
    return None if of is None else partial(of, one)


def _rerouted(
    one: StuckBit | LinkErrors, block: Expected, pixel: tuple[int, int], codes: Floats, p: Floats
) -> Floats:
    top = block.scan.sensor.top_code
    chance = one.strength * (codes / top if isinstance(one, LinkErrors) else 1.0)
    if one.shape == "one_tap" and block.scan.sensor.taps[pixel] != 0:
        return p
    first = int(codes[0])
    target = np.clip(one.changed(codes.astype(np.int64)) - first, 0, len(codes) - 1)
    stays = p * (1 - chance)
    return np.asarray(stays + np.bincount(target, p * chance, len(codes)))


def _uneven(
    one: AdcDnl, block: Expected, pixel: tuple[int, int], codes: Floats, _: Floats
) -> Floats:
    mean, sigma = block.dn[0][pixel], np.sqrt(block.variance[0][pixel] - 1 / 12)
    edges = np.concatenate([[-np.inf], one.edges, [np.inf]])
    first = int(codes[0])
    return np.diff(ndtr((edges[first : first + len(codes) + 1] - mean) / sigma))


def _clipped(
    one: BlackClip, block: Expected, pixel: tuple[int, int], codes: Floats, p: Floats
) -> Floats:
    if one.shape == "one_tap" and block.scan.sensor.taps[pixel] != 0:
        return p
    below = codes < one.black_dn
    target = np.where(below, one.black_dn, codes).astype(np.int64)
    if one.shape == "half_scale":
        half = one.black_dn - (one.black_dn - codes.astype(np.int64)) // 2
        target = np.where(below, half, target)
    target = np.clip(target - int(codes[0]), 0, len(codes) - 1)
    return np.asarray(np.bincount(target, p, len(codes)), dtype=float)


def _tailed(
    one: Mechanism, block: Expected, pixel: tuple[int, int], codes: Floats, p: Floats
) -> Floats:
    gain, read = block.gain[0][pixel], block.scan.sensor.read_noise_e
    wide = gain * np.sqrt(block.electrons[0][pixel] + 36.0 * read**2)
    tail = _normal(codes, block.dn[0][pixel], wide)
    return np.asarray((1 - one.strength) * p + one.strength * tail)


def _two_levels(
    one: RtsPixels, block: Expected, pixel: tuple[int, int], codes: Floats, p: Floats
) -> Floats:
    k = int(np.flatnonzero(one.places == pixel[0] * block.scan.sensor.columns + pixel[1])[0])
    up = one.up_chance[k] / (one.up_chance[k] + one.down_chance[k])
    sigma = np.sqrt(block.variance[0][pixel] - 1 / 12)
    high = _normal(codes, block.dn[0][pixel] + one.strength, sigma)
    return np.asarray((1 - up) * p + up * high)


def _hit(
    one: CosmicRays, block: Expected, pixel: tuple[int, int], codes: Floats, p: Floats
) -> Floats:
    length = {"short": 2.7, "long": 20.5, "halo": 7.0}[one.shape]
    chance, sigma = one.events_per_pixel * length, np.sqrt(block.variance[0][pixel] - 1 / 12)
    mean_dn = one.strength / length * block.gain[0][pixel]
    added = -np.log1p(-(np.arange(12) + 0.5) / 12) * mean_dn
    hits = [_normal(codes, block.dn[0][pixel] + dn, sigma) for dn in added]
    return np.asarray((1 - chance) * p + chance * np.mean(hits, axis=0))


_BY_NAME: dict[str, Callable[..., Floats]] = {
    "stuck_bit": _rerouted,
    "link_errors": _rerouted,
    "adc_dnl": _uneven,
    "black_clip": _clipped,
    "heavy_tailed_noise": _tailed,
    "rts_pixels": _two_levels,
    "cosmic_rays": _hit,
}
