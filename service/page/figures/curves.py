"""The curves of a coefficient set, and how two sets differ."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from calib.arrays import Columns
from calib.radiometric.coefficients.coefficient_set import CoefficientSet
from service.page.figures.plot import FIRST, SECOND, Figure, banded, figure


@dataclass(frozen=True)
class Curve:
    """One quantity of a set, by column, and how two sets are compared in it."""

    name: str
    unit: Callable[[CoefficientSet], str]
    value: Callable[[CoefficientSet], Columns]
    std: Callable[[CoefficientSet], Columns]
    relative: bool
    """Whether sets are compared by ratio."""


CURVES: tuple[Curve, ...] = (
    Curve("DN0", lambda _: "DN", lambda s: s.dark_offset_dn, lambda s: s.dark_offset_dn_std, False),
    Curve("VE", lambda _: "1", lambda s: s.vignette, lambda s: s.vignette_std, True),
    Curve(
        "QE",
        lambda s: f"DN / ({s.radiance_unit} µs)",
        lambda s: s.responsivity,
        lambda s: s.responsivity_std,
        True,
    ),
)


def curve(shown: CoefficientSet, what: Curve) -> Figure:
    """Draw one quantity with its uncertainty (k = 2); masked columns are gaps."""
    lines = _lines(shown, what, shown.id[:8], FIRST)
    return figure(lines, x="column", y=_title(shown, what))


def both(first: CoefficientSet, second: CoefficientSet, what: Curve) -> Figure:
    """Draw one quantity of two sets over each other."""
    lines = [
        *_lines(first, what, first.id[:8], FIRST),
        *_lines(second, what, second.id[:8], SECOND),
    ]
    return figure(lines, x="column", y=_title(first, what), showlegend=True)


def difference(first: CoefficientSet, second: CoefficientSet, what: Curve) -> Figure:
    """Draw by how much the second set differs from the first, with k = 2.

    Uncertainties are added as those of independent values (GUM, 5.1.2): two sets that share a
    radiance standard differ by less than the band says.
    """
    a, b = _masked(first, what.value(first)), _masked(second, what.value(second))
    u_a, u_b = what.std(first), what.std(second)
    if what.relative:
        value = 100.0 * (b / a - 1.0)
        std = 100.0 * np.abs(b / a) * np.hypot(u_a / a, u_b / b)
        y = f"{what.name}: {second.id[:8]}<br>/ {first.id[:8]} − 1, %"
    else:
        value, std = b - a, np.hypot(u_a, u_b)
        y = f"{what.name}: {second.id[:8]}<br>− {first.id[:8]}, {what.unit(first)}"
    return figure(banded(_columns(first), value, std, name=what.name), x="column", y=y)


def _lines(shown: CoefficientSet, what: Curve, name: str, color: str) -> list[dict[str, Any]]:
    value = _masked(shown, what.value(shown))
    return banded(_columns(shown), value, what.std(shown), name=name, color=color)


def _title(shown: CoefficientSet, what: Curve) -> str:
    unit = what.unit(shown)
    return what.name if unit == "1" else f"{what.name}<br>{unit}"


def _columns(shown: CoefficientSet) -> Columns:
    return np.arange(shown.n_columns, dtype=float)


def _masked(shown: CoefficientSet, values: Columns) -> Columns:
    return np.where(shown.valid, values, np.nan)
