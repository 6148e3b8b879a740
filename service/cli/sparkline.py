"""A profile in one line of text."""

from collections.abc import Sequence
from itertools import pairwise

_BARS = "▁▂▃▄▅▆▇█"


def sparkline(values: Sequence[float], width: int = 64) -> str:
    """Return `values`, averaged into `width` bars from 0 to their largest.

    >>> sparkline([0.0, 1.0, 2.0, 4.0], width=4)
    '▁▃▅█'
    """
    n = len(values)
    edges = [i * n // width for i in range(width + 1)]
    bins = [values[a : max(a + 1, b)] for a, b in pairwise(edges)]
    means = [sum(each) / len(each) for each in bins]
    largest = max(means)
    if not largest > 0:
        return _BARS[0] * width
    steps = len(_BARS) - 1
    return "".join(_BARS[max(0, min(steps, round(mean / largest * steps)))] for mean in means)
