"""What Bluesky's documents say of one value: a reading, and what it is."""

import time
from typing import Any, TypedDict

from numpy.typing import NDArray


class Reading(TypedDict):
    """A value, and when it was taken, Unix time in seconds."""

    value: Any
    timestamp: float


class DataKey(TypedDict, total=False):
    """What a value is."""

    source: str
    dtype: str
    shape: list[int]
    units: str


def reading(value: Any, at_s: float | None = None) -> Reading:
    """Return `value` as it was at `at_s`, now where None."""
    return {"value": value, "timestamp": time.time() if at_s is None else at_s}


def number(source: str, units: str) -> DataKey:
    """Describe a number."""
    return {"source": source, "dtype": "number", "shape": [], "units": units}


def array(source: str, units: str, like: NDArray[Any]) -> DataKey:
    """Describe an array."""
    return {"source": source, "dtype": "array", "shape": list(like.shape), "units": units}
