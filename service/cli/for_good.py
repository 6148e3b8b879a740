"""What a start makes lives as long as the process: nobody needs to look for garbage in it."""

import gc
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def for_good() -> Iterator[None]:
    """Collect no garbage inside, and never look through what is there at the end.

    While a service's modules come in, looking for garbage takes 0.45 of 1.9 s of processor time; to
    look through all of them once more, before the server begins, another 0.3 s.
    """
    gc.disable()
    try:
        yield
        gc.freeze()
    finally:
        gc.enable()
