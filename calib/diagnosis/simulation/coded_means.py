"""What effects of codes do to means: averaged over each pixel's own noise, not over drawn lines."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.random import default_rng
from numpy.typing import NDArray
from scipy.special import ndtri

from calib.diagnosis.simulation.chain_run import FittedChain
from calib.forward.conditions import Conditions
from calib.forward.effect import Effect, Stage
from calib.forward.effects.adc import Adc
from calib.forward.effects.catalogue import place_of

Floats = NDArray[np.float64]

NODES = 64
"""Quantiles of the normal distribution, of equal weight."""
SMOOTH_NODES = 8
"""As many do where nothing is rounded."""
ROUNDED_DN = 0.5
"""Noise beyond this averages rounding out of a mean: exp(-2 pi^2 std^2) of it is left."""
TOGETHER = 1 << 18
"""Samples of blocks that go together: more leave the caches."""


def moved_by_codes(chain: FittedChain, effects: Sequence[Effect], moved: Floats) -> Floats:
    """Return by how much effects of codes move all means, DN, (n_blocks, n_pixels).

    Few drawn lines would tell by how rounding scatters in them. Where no other effect moves means,
    the latest is kept: two draws and the histogram ask for the same.

    Args:
        chain: Of the links.
        effects: Those that act on codes count.
        moved: By how much the others move the means, DN, likewise.
    """
    coded = tuple(effect for effect in effects if effect.stage >= Stage.CODES)
    if moved.any():
        return _moved(chain, coded, moved)
    return chain.coded_means.of(coded, lambda: _moved(chain, coded, moved))


def _moved(chain: FittedChain, effects: Sequence[Effect], moved: Floats) -> Floats:
    mean = chain.baseline.mean_dn.reshape(moved.shape) + moved
    variance = chain.baseline.variance_dn2.reshape(moved.shape)
    found = np.empty_like(mean)
    for which in _together(effects, variance):
        at = chain.table.at(which[0], np.zeros(1))
        found[which] = coded_means(chain, effects, at, mean[which], variance[which])
    return found


def _together(effects: Sequence[Effect], variance: Floats) -> list[list[int]]:
    """Return blocks whose lines can go together: that are all rounded or none, if effects allow."""
    most = max(TOGETHER // (NODES * variance.shape[1]), 1)
    if not all(e.by_signal for e in effects if e.stage >= Stage.CODES):
        most = 1
    rounded = _std(variance).min(axis=1) <= ROUNDED_DN
    kinds = [np.flatnonzero(rounded).tolist(), np.flatnonzero(~rounded).tolist()]
    return [kind[k : k + most] for kind in kinds for k in range(0, len(kind), most)]


def _std(variance: Floats) -> Floats:
    """Return the noise of samples before they are rounded, DN."""
    return np.sqrt(np.maximum(variance - 1.0 / 12.0, 1e-4))


def coded_means(
    chain: FittedChain, effects: Sequence[Effect], at: Conditions, mean: Floats, variance: Floats
) -> Floats:
    """Return by how much `effects` of codes move the means of pixels, DN, (..., n_pixels).

    Args:
        chain: Of the links.
        effects: Those that act on codes count.
        at: Conditions of the block; of several together, any one's.
        mean: Of each pixel before the conversion, DN, (..., n_pixels).
        variance: Of its samples, rounding included, likewise.
    """
    coded = [e for e in effects if e.stage >= Stage.CODES]
    std = _std(variance)
    adc = Adc(chain.sensor.camera.bit_depth)
    smooth = std.min() > ROUNDED_DN and all(place_of(e) < place_of(adc) for e in coded)
    n = SMOOTH_NODES if smooth else NODES
    nodes = ndtri((np.arange(n) + 0.5) / n)
    lines = mean + nodes.reshape(-1, *(1,) * mean.ndim) * std
    lines = lines.reshape(-1, *chain.sensor.sample)
    at = replace(at, line_times_s=np.full(len(lines), float(at.line_times_s[0])))
    if smooth:
        top = float(chain.sensor.camera.full_scale_dn)
        moved, plain = (np.clip(_run(links, lines, at), 0.0, top) for links in (coded, ()))
    else:
        moved, plain = (_run(links, lines, at) for links in ((*coded, adc), (adc,)))
    return np.asarray((moved - plain).reshape(n, *mean.shape).mean(axis=0))


def _run(links: Sequence[Effect], lines: Floats, at: Conditions) -> Floats:
    for link in sorted(links, key=place_of):
        lines = np.asarray(link.apply(lines, at, default_rng(0)), np.float64)
    return lines
