"""Small plans for tests."""

from typing import Any

from service.plan.model import Plan

BASE: dict[str, Any] = {
    "sweep": {"type": "exposure", "exposures_us": [100.0, 200.0, 300.0], "level": 1},
    "camera": {"line_period_us": 1000.0, "columns": 64},
    "lines": 64,
}


def content(**changes: Any) -> dict[str, Any]:
    """Return what a plan file would say, some of its keys changed."""
    return {**BASE, **changes}


def plan(**changes: Any) -> Plan:
    """Return the plan."""
    return Plan.parse(content(**changes))


def factorial(exposures: int = 3, levels: int = 2) -> dict[str, Any]:
    """Return a full factorial sweep."""
    return {
        "type": "factorial",
        "exposures_us": [100.0 * (i + 1) for i in range(exposures)],
        "levels": [float(i + 1) for i in range(levels)],
    }
