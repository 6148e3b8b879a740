"""The chance of each code where faults of codes happen, at means between which all pixels' lie.

A pixel of mean mu and noise s gives the code k with the chance Phi((k + 1/2 - mu) / s) -
Phi((k - 1/2 - mu) / s), the lowest and the highest code with all that lies beyond. A fault that
happens with a chance p moves that share p of each code to another one.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from calib.forward.code_fault import CodeFault
from calib.kernels import expected_histogram as kernel

Floats = NDArray[np.float64]

REACH = 7.0
"""Codes so many standard deviations away from a mean do not happen."""
ROUNDED_DN = 0.6
"""Noise beyond this leaves 1e-3 of a DN of what rounding does to a mean: exp(-2 pi^2 std^2)."""
FINE = 4.0
"""Nodes lie this part of a standard deviation apart: between them lines err by 1/(8 x 16)."""
COARSE = 20
"""Of so many codes in a standard deviation, and more, every third, fifth ... stands for all."""


def nodes_between(means: Floats, noise: float) -> Floats:
    """Return means, ascending, between which all pixels' lie; the pixels' own if these are few."""
    wanted = 2 + int(np.ptp(means) * FINE / noise)
    own: Floats = np.unique(means)
    return own if len(own) <= wanted else np.linspace(own[0], own[-1], wanted)


def code_chances(nodes: Floats, spread: Floats, top: int) -> tuple[Floats, Floats]:
    """Return codes about each node and the chance of each, (n_nodes, n_codes)."""
    # An odd step meets codes with a bit set as often as codes without.
    step = 2 * int(spread.min() / COARSE / 2) + 1
    first = np.floor(nodes - REACH * spread)
    steps = np.arange(0.0, np.ceil(2.0 * REACH * spread.max()) + 2.0 * step, step)
    chance = kernel.code_chances((nodes - first) / step, spread / step, len(steps))
    return np.clip(first[:, None] + steps, 0.0, float(top)), chance


def stored_chances(
    codes: Floats, chance: Floats, faults: Sequence[CodeFault]
) -> tuple[Floats, Floats]:
    """Return stored codes and the chance of each, faults side by side with what has none."""
    for fault in faults:
        p, changed = fault.chance, np.asarray(fault.faulty(codes), np.float64)
        if p == 1.0:
            codes = changed
            continue
        codes = np.concatenate([codes, changed], axis=1)
        chance = np.concatenate([(1.0 - p) * chance, p * chance], axis=1)
    return codes, chance


def are_touched(means: Floats, variance: Floats, faults: Sequence[CodeFault], top: int) -> bool:
    """Return whether any code that these pixels give is changed by any of `faults`."""
    reach = REACH * np.sqrt(variance.max()) + 1.0
    low, high = (np.clip(x, 0.0, top) for x in (means.min() - reach, means.max() + reach))
    codes = np.arange(np.floor(low), np.ceil(high) + 1.0)
    return any(bool((fault.faulty(codes) != codes).any()) for fault in faults)


def is_gaussian(nodes: Floats, spread: Floats, top: int) -> bool:
    """Return whether rounding adds its own noise, and no code lies at an end of the range."""
    reach = REACH * float(spread.max())
    inside = nodes[0] - reach > 0.0 and nodes[-1] + reach < top
    return bool(inside and spread.min() > ROUNDED_DN)


def straight(means: Floats, values: Floats, places: Floats) -> Floats:
    """Return the straight function of the means that `values` follow, at `places`."""
    off = means - means.mean()
    slope = float(off @ values) / max(float(off @ off), 1e-12)
    return np.asarray(values.mean() + slope * (places - means.mean()))


def about_nodes(nodes: Floats, means: Floats, values: Floats) -> Floats:
    """Return the values that pixels have about each node, (n_nodes,)."""
    k = np.clip(np.searchsorted(nodes, means, side="right") - 1, 0, max(len(nodes) - 2, 0))
    after = np.minimum(k + 1, len(nodes) - 1)
    share = np.clip((means - nodes[k]) / np.maximum(nodes[after] - nodes[k], 1e-12), 0.0, 1.0)
    weight, total = np.zeros(len(nodes)), np.zeros(len(nodes))
    for node, part in ((k, 1.0 - share), (after, share)):
        weight += np.bincount(node, part, len(nodes))
        total += np.bincount(node, part * values, len(nodes))
    known = weight > 0.0
    return np.interp(nodes, nodes[known], total[known] / weight[known])
