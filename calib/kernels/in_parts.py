"""Work on large maps, a cacheful of pixels at a time, on all cores."""

import os
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

PIXELS = 32768
"""Intermediate results of so many pixels stay in the cache."""

T = TypeVar("T")


def in_parts(n: int, work: Callable[[slice], T], *, at_once: int = PIXELS) -> Iterator[T]:
    """Yield `work` of consecutive pixels (or rows), in their order.

    The parts depend on `n` alone, not on the machine. NumPy and compiled loops release the
    interpreter, so that threads work side by side.

    >>> [part for part in in_parts(70_000, lambda some: some.start)]
    [0, 32768, 65536]
    """
    parts = [slice(k, min(k + at_once, n)) for k in range(0, n, at_once)]
    if len(parts) < 2:
        yield from map(work, parts)
        return
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        yield from pool.map(work, parts)
