"""What a start makes lives as long as the process: nobody needs to look for garbage in it."""

import gc
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def for_good() -> Iterator[None]:
    """Collect no garbage inside, and never look through what is there at the end.

    A service's modules and routes are a quarter of a million objects. While they come in, looking
    for garbage takes 0.45 of 1.9 s of processor time. Later no thread goes on while Python looks
    whether one of them became garbage, and every answer would wait: 0.2 s every 12 s under load.
    """
    gc.disable()
    try:
        yield
        gc.freeze()
    finally:
        gc.enable()
