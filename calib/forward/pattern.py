"""Fixed patterns: numbers that belong to a pixel for the sensor's life."""

from functools import lru_cache
from math import prod
from zlib import crc32

import numpy as np
from numpy.random import Generator, default_rng

from calib.arrays import Pixels, SampleShape
from calib.errors import InputError
from calib.recording.frame_codes import sample_shape
from calib.recording.header import CameraHeader


def pattern_generator(seed: int, effect: str) -> Generator:
    """Return the generator of a fixed pattern.

    The effect's name goes into the seed, so that two effects with one seed stay independent.
    """
    return default_rng([seed, crc32(effect.encode())])


@lru_cache(maxsize=16)
def normal_pattern(seed: int, effect: str, sample: SampleShape) -> Pixels:
    """Return a standard normal number for each pixel, (*sample,), read-only."""
    pattern = np.asarray(pattern_generator(seed, effect).standard_normal(sample))
    pattern.flags.writeable = False
    return pattern


def explicit_pattern(values: tuple[float, ...], sample: SampleShape) -> Pixels:
    """Return the values given one by one in a model file, row by row, (*sample,)."""
    return np.asarray(values, dtype=np.float64).reshape(sample)


def pixel_count(camera: CameraHeader) -> int:
    """Return how many pixels a sample of `camera` has."""
    return prod(sample_shape(camera))


def check_length(values: tuple[float, ...], wanted: int, where: str) -> None:
    """Raise InputError unless `values` is empty or has as many elements as wanted."""
    if values and len(values) != wanted:
        raise InputError(
            f"{where} has {len(values)} values; give {wanted} or none.", code="wrong-length"
        )
