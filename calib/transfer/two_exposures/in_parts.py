"""Work on large maps, a cacheful of pixels at a time, on all cores."""

import os
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

PIXELS = 32768
"""Intermediate results of so many pixels stay in the cache."""

T = TypeVar("T")


def in_parts(n_pixels: int, work: Callable[[slice], T]) -> Iterator[T]:
    """Yield `work` of consecutive pixels, in their order; NumPy releases the interpreter.

    >>> [part for part in in_parts(70_000, lambda some: some.start)]
    [0, 32768, 65536]
    """
    parts = [slice(k, min(k + PIXELS, n_pixels)) for k in range(0, n_pixels, PIXELS)]
    if len(parts) < 2:
        yield from map(work, parts)
        return
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        yield from pool.map(work, parts)
