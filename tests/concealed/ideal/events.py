"""What single events are worth: those that chance made in a recording, not those of the mean one.

A filter that knows an effect's law, but not where chance has it act, weighs each sample (or line,
or track) x by r(x) = 1 - s + s a(x) / p(x): a share s has the density a in the place of p. With
R = s a / ((1 - s) p), n samples of which s n are events tell, on average and as long as s is small,

    n KL = n (1 - s) E_p[(1 + R) ln(1 + R) - R] = n s E_a[(1 + 1/R) ln(1 + R) - 1],

for s a = (1 - s) p R. The second form is a sum over events: `worth` of each of those that happened
has that mean, is never negative, about ln R - 1 where an event stands out, and nothing where none
did. Twice the sum is the deviance. The noise that falls on an event is averaged over.
"""

from collections.abc import Sequence
from math import log

import numpy as np
from numpy.random import default_rng
from numpy.typing import NDArray
from scipy.special import log_ndtr

from tests.concealed.generator.mechanism import Mechanism
from tests.concealed.generator.mechanisms.codes import DuplicatedLines
from tests.concealed.generator.mechanisms.collection import CosmicRays, Track
from tests.concealed.generator.mechanisms.electronics import HeavyTailedNoise, Outlying
from tests.concealed.generator.scan import Happened
from tests.concealed.ideal.expected import Expected
from tests.concealed.ideal.quiet import Floats

EVENTS = {
    "duplicated_lines", "cosmic_rays", "heavy_tailed_noise", "stuck_bit", "link_errors"
}  # fmt: skip
"""What shows in events that chance makes; bits that flip are in `distributions.py`."""
_DRAWS = 32
_MOST_EVENTS = 2000
_LEAST_LOG = -138.0
"""ln 1e-60: less likely is nothing, whatever a Gaussian says of a hundred standard deviations."""


def event_deviance(one: Mechanism, plain: Sequence[Expected], happened: Happened) -> float:
    """Return it of lines sent twice, rays and tails as they happened, 0 of all other effects."""
    if one.name not in happened:
        return 0.0
    each = zip(plain, happened[one.name], strict=True)
    if isinstance(one, DuplicatedLines):
        return 2.0 * sum(_repeated(one, block, again) for block, again in each)
    if isinstance(one, HeavyTailedNoise):
        return 2.0 * sum(_outlying(one, block, reads) for block, reads in each)
    if isinstance(one, CosmicRays):
        return 2.0 * sum(_track(one, block, track) for block, tracks in each for track in tracks)
    return 0.0


def worth(log_ratio: Floats) -> Floats:
    """Return (1 + 1/R) ln(1 + R) - 1 of ln R: R / 2 if that is small, ln R - 1 if it is large."""
    clipped = np.maximum(log_ratio, -30.0)
    return np.asarray((1.0 + np.exp(-clipped)) * np.logaddexp(0.0, clipped) - 1.0)


def _repeated(one: DuplicatedLines, block: Expected, again: int) -> float:
    """Of a line that is known from the one before; without that, it has the entropy of its noise.

    That of a normal variable is ln(sigma sqrt(2 pi e)), rounding in sigma; of less than a code
    there is next to none.
    """
    pixels = slice(block.scan.sensor.columns // 2 if one.shape == "half" else 0, None)
    variance = block.variance[0][:, pixels]
    nats = float(np.maximum(0.5 * np.log(2 * np.pi * np.e * variance), 0.0).sum())
    ratio = log(one.strength) - log(max(1.0 - one.strength, 1e-300)) + nats
    return float(again * worth(np.array(ratio)))


def _outlying(one: HeavyTailedNoise, block: Expected, reads: Outlying) -> float:
    """Of reads whose noise is of another kind, where the charge has shot noise besides."""
    step = -(-len(reads.sample) // _MOST_EVENTS) or 1
    at, read = reads.sample[::step], block.scan.sensor.read_noise_e
    gain, variance = block.gain.ravel()[at], block.variance.ravel()[at]
    rest = variance - (gain * read) ** 2
    off = _shown(gain * reads.noise_e[::step] + _normal(len(at)) * np.sqrt(rest), block, at)
    if one.shape == "mixture":
        other = _gaussian(off, rest + (6.0 * gain * read) ** 2)
    elif one.shape == "one_sided":
        other = _charged(off, rest, 6.0 * gain * read)
    else:
        sides = [_charged(sign * off, rest, 4.0 * gain * read) for sign in (1.0, -1.0)]
        other = np.logaddexp(*sides) - log(2.0)
    usual = np.maximum(_gaussian(off, variance), _LEAST_LOG)
    return float(step * worth(log(one.strength / (1 - one.strength)) + other - usual).mean(0).sum())


def _track(one: CosmicRays, block: Expected, track: Track) -> float:
    """Of a particle's charges: any pixels of its track, side by side, may be all that it hit."""
    n, shape = len(track.charge_e), block.scan.shape
    first = np.ravel_multi_index((track.sample, track.row, track.first), shape)
    at = first + np.arange(n)
    gain, variance = block.gain.ravel()[at], block.variance.ravel()[at]
    room_e = np.maximum(block.scan.sensor.full_well_e - block.electrons.ravel()[at], 0.0)
    added = gain * np.minimum(track.charge_e, room_e)
    off = _shown(added + _normal(n) * np.sqrt(variance), block, at)
    usual = np.maximum(_gaussian(off, variance), _LEAST_LOG)
    parts = [slice(a, b) for a in range(n) for b in range(a + 2, n + 1)]
    found = []
    for part in parts if one.shape == "short" and n > 1 else [slice(0, n)]:
        chance, mean_e = _law(one, part.stop - part.start)
        likelier = _charged(off[:, part], variance[part], gain[part] * mean_e) - usual[:, part]
        found.append(log(chance) + likelier.sum(axis=1))
    every = np.logaddexp.reduce(np.array(found), axis=0)
    return float(worth(log(one.events_per_pixel) + every).mean())


def _law(one: CosmicRays, n: int) -> tuple[float, Floats]:
    """Return the chance of a track of `n` pixels, and each one's mean charge."""
    if one.shape == "halo":
        weight = np.exp(-np.abs(np.arange(n) - n // 2) / 1.5)
        return 1.0, np.asarray(one.strength * weight / weight.sum())
    chance = 1.0 / 18 if one.shape == "long" else 0.6 * 0.4 ** (n - 2) if n > 1 else 1.0
    return chance, np.full(n, one.strength / n)


def _shown(off_dn: Floats, block: Expected, at: NDArray[np.intp]) -> Floats:
    """Return what the codes' range leaves of deviations."""
    dn = block.dn.ravel()[at]
    return np.asarray(np.clip(off_dn, -dn, block.scan.sensor.top_code - dn))


def _normal(n: int) -> Floats:
    """Return noise that is the same each time, (_DRAWS, n)."""
    return default_rng(n).standard_normal((_DRAWS, n))


def _gaussian(off: Floats, variance: Floats) -> Floats:
    return np.asarray(-0.5 * off**2 / variance - 0.5 * np.log(2 * np.pi * variance))


def _charged(off: Floats, variance: Floats, mean: Floats) -> Floats:
    """Return ln of the density of Gaussian noise and an exponential charge of that mean."""
    sigma = np.sqrt(variance)
    falls = 0.5 * variance / mean**2 - off / mean
    return np.asarray(log_ndtr(off / sigma - sigma / mean) + falls - np.log(mean))
