"""Area frames that come one by one, several at a time: what each call costs is then shared."""

from collections.abc import Iterable, Iterator
from typing import cast

import numpy as np

from calib.arrays import RawLines

_MOST_FRAMES = 32
_MOST_BYTES = 1 << 26


def gathered(frames: Iterable[RawLines]) -> Iterator[RawLines]:
    """Yield the frames of `frames`, each (n_frames, n_rows, n_columns), in stacks of up to 32.

    A stack holds 64 MiB at most, or as many as came at once.
    """
    waiting: list[RawLines] = []
    n_frames = n_bytes = 0
    for dn in frames:
        if waiting and (n_frames + len(dn) > _MOST_FRAMES or n_bytes + dn.nbytes > _MOST_BYTES):
            yield _together(waiting)
            waiting, n_frames, n_bytes = [], 0, 0
        waiting.append(dn)
        n_frames, n_bytes = n_frames + len(dn), n_bytes + dn.nbytes
    if waiting:
        yield _together(waiting)


def _together(frames: list[RawLines]) -> RawLines:
    return frames[0] if len(frames) == 1 else cast("RawLines", np.concatenate(frames))
