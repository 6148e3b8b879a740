"""Fixed patterns: numbers that belong to a column for the sensor's life."""

from functools import lru_cache
from zlib import crc32

import numpy as np
from numpy.random import Generator, default_rng

from calib.arrays import Columns
from calib.errors import InputError


def pattern_generator(seed: int, effect: str) -> Generator:
    """Return the generator of a fixed pattern.

    The effect's name goes into the seed, so that two effects with one seed stay independent.
    """
    return default_rng([seed, crc32(effect.encode())])


@lru_cache(maxsize=64)
def normal_pattern(seed: int, effect: str, n_columns: int) -> Columns:
    """Return a standard normal number for each column, (n_columns,), read-only."""
    pattern = pattern_generator(seed, effect).standard_normal(n_columns)
    pattern.flags.writeable = False
    return pattern


def explicit_pattern(values: tuple[float, ...]) -> Columns:
    """Return the values given one by one in a model file, (n_columns,)."""
    return np.asarray(values, dtype=np.float64)


def check_length(values: tuple[float, ...], wanted: int, where: str) -> None:
    """Raise InputError unless `values` is empty or has as many elements as wanted."""
    if values and len(values) != wanted:
        raise InputError(
            f"{where} has {len(values)} values; give {wanted} or none.", code="wrong-length"
        )
