"""Answers as JSON knows them: no NaN, no infinity, no NumPy, no path."""

import json
import math
from collections.abc import Mapping
from datetime import datetime
from enum import Enum
from pathlib import Path
from typing import Any


def plain(value: Any) -> Any:
    """Return `value` made of dict, list, str, int, float, bool and None.

    A number that is not finite is one that is not known: None.

    >>> plain({"x": float("nan"), "at": Path("a"), "n": (1, 2.5)})
    {'x': None, 'at': 'a', 'n': [1, 2.5]}
    """
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple | set | frozenset):
        return [plain(item) for item in value]
    if hasattr(value, "tolist"):  # NumPy's arrays and scalars, without importing NumPy
        return plain(value.tolist())
    return _plain_scalar(value)


def _plain_scalar(value: Any) -> Any:
    match value:
        case Enum():
            return _plain_scalar(value.value)
        case float():
            return float(value) if math.isfinite(value) else None
        case None | bool() | int() | str():
            return value
        case datetime():
            return value.isoformat()
        case Path():
            return str(value)
    msg = f"{type(value).__name__} has no form in JSON"
    raise TypeError(msg)


def dumps(value: Any) -> str:
    """Return `value` as indented JSON with a newline at the end."""
    return json.dumps(plain(value), indent=2, ensure_ascii=False, allow_nan=False) + "\n"
