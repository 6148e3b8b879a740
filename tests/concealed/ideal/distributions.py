"""What a changed distribution of a pixel's codes is worth: 2 n KL(changed, plain).

The plain one may take the changed one's mean, which an offset absorbs. Of codes that a chance of
each changes, that is taken as often as it happened.
"""

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np
from scipy.special import ndtr

from tests.concealed.generator.mechanism import Mechanism
from tests.concealed.generator.mechanisms.codes import AdcDnl, BlackClip, StuckBit
from tests.concealed.generator.mechanisms.electronics import RtsPixels
from tests.concealed.generator.mechanisms.unlisted_volts import LinkErrors
from tests.concealed.generator.scan import Happened
from tests.concealed.ideal.expected import Expected
from tests.concealed.ideal.quiet import Floats

_MOST_PIXELS = 16
_REACH = 7.0
_LEAST = 1e-60
Change = Callable[[Expected, tuple[int, int], Floats, Floats], Floats]
"""Block, pixel, codes and their plain probabilities in; changed probabilities out."""


def distribution_deviance(one: Mechanism, plain: Sequence[Expected], happened: Happened) -> float:
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
    found = [_pixel(block, pixel, change) for block in plain for pixel in pixels]
    if isinstance(one, StuckBit | LinkErrors):
        times = share * sum(_times(one, block, pixel) for block in plain for pixel in pixels)
        share *= sum(happened[one.name]) / times if times > 0 else 1.0
    return share * sum(found)


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
    first, chance = int(codes[0]), _chances(one, block, pixel, codes)
    target = np.clip(one.changed(codes.astype(np.int64)) - first, 0, len(codes) - 1)
    stays = p * (1 - chance)
    return np.asarray(stays + np.bincount(target, p * chance, len(codes)))


def _times(one: StuckBit | LinkErrors, block: Expected, pixel: tuple[int, int]) -> float:
    """Return how many of a pixel's codes are expected to be changed."""
    mean, sigma = block.dn[0][pixel], np.sqrt(block.variance[0][pixel] - 1 / 12)
    codes = _codes(mean, sigma, block)
    moved = one.changed(codes.astype(np.int64)) != codes
    p = _normal(codes, mean, sigma)
    return float(block.scan.n_samples * (p * _chances(one, block, pixel, codes))[moved].sum())


def _chances(
    one: StuckBit | LinkErrors, block: Expected, pixel: tuple[int, int], codes: Floats
) -> Floats:
    """Return how likely each of `codes` is to be changed."""
    if one.shape == "one_tap" and block.scan.sensor.taps[pixel] != 0:
        return np.zeros(len(codes))
    top = block.scan.sensor.top_code
    relative = codes / top if isinstance(one, LinkErrors) else np.ones(len(codes))
    return np.asarray(one.strength * relative)


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


def _two_levels(
    one: RtsPixels, block: Expected, pixel: tuple[int, int], codes: Floats, p: Floats
) -> Floats:
    k = int(np.flatnonzero(one.places == pixel[0] * block.scan.sensor.columns + pixel[1])[0])
    up = one.up_chance[k] / (one.up_chance[k] + one.down_chance[k])
    sigma = np.sqrt(block.variance[0][pixel] - 1 / 12)
    high = _normal(codes, block.dn[0][pixel] + one.strength, sigma)
    return np.asarray((1 - up) * p + up * high)


_BY_NAME: dict[str, Callable[..., Floats]] = {
    "stuck_bit": _rerouted,
    "link_errors": _rerouted,
    "adc_dnl": _uneven,
    "black_clip": _clipped,
    "rts_pixels": _two_levels,
}
