"""What effects of codes do to means: averaged over each pixel's own noise, not over drawn lines."""

from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache

import numpy as np
from numpy.random import default_rng
from numpy.typing import NDArray
from scipy.stats import norm

from calib.diagnosis.simulation.chain_run import FittedChain
from calib.forward.conditions import Conditions
from calib.forward.effect import Effect, Stage
from calib.forward.effects.adc import Adc
from calib.forward.effects.catalogue import place_of

Floats = NDArray[np.float64]

NODES = 64
"""Quantiles of the normal distribution, of equal weight."""
_CHANCE = default_rng(0)


def coded_means(
    chain: FittedChain, effects: Sequence[Effect], at: Conditions, mean: Floats, variance: Floats
) -> Floats:
    """Return by how much `effects` of codes move the means of pixels, DN, (n_pixels,).

    Args:
        chain: Of the links.
        effects: Those that act on codes count.
        at: Conditions of the block.
        mean: Of each pixel before the conversion, DN, (n_pixels,).
        variance: Of its samples, rounding included, likewise.
    """
    coded = [e for e in effects if e.stage >= Stage.CODES]
    std = np.sqrt(np.maximum(variance - 1.0 / 12.0, 1e-4))
    lines = (mean + _nodes()[:, None] * std).reshape(NODES, *chain.sensor.sample)
    at = replace(at, line_times_s=np.full(NODES, float(at.line_times_s[0])))
    adc = Adc(chain.sensor.camera.bit_depth)
    moved, plain = (_run(links, lines, at) for links in ((*coded, adc), (adc,)))
    return np.asarray((moved - plain).mean(axis=0).ravel())


@lru_cache
def _nodes() -> Floats:
    return np.asarray(norm.ppf((np.arange(NODES) + 0.5) / NODES))


def _run(links: Sequence[Effect], lines: Floats, at: Conditions) -> Floats:
    for link in sorted(links, key=place_of):
        lines = np.asarray(link.apply(lines, at, _CHANCE), np.float64)
    return lines
