"""The two lines of a data sheet: noise against signal, and signal against light; with residuals.

Source: EMVA Standard 1288, Release 4.0 Linear, sections 6.6 and 6.9.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from service.page.figures.plot import FIRST, SECOND, SOFT, Figure, dots, figure, straight

Vector = NDArray[np.float64]
_CLIPPED: Final = 0.002
_SIGNAL: Final = "µ − µ<sub>dark</sub> / DN"


@dataclass(frozen=True, eq=False)
class Points:
    """The flats of a data sheet, each array (n_flats,).

    Attributes:
        light: Exposure times level, µs, or photons per pixel where the source states them.
        light_name: Which of them.
        signal_dn: Mean less the dark's.
        signal_std: Its standard uncertainty, DN.
        variance_dn2: Temporal variance less the dark's.
        variance_std: Its standard uncertainty, DN².
        in_fit: Whether the system gain is from it: 0 to 70 % of saturation.
        is_clipped: Whether more than 0.2 % of its samples stand at full scale.
        gain: Slope of variance against signal, through the origin, DN/e-; NaN where unknown.
        offset: Of the line of the signal against the light, DN; NaN where there is none.
        slope: Of that line, DN per unit of `light`.
    """

    light: Vector
    light_name: str
    signal_dn: Vector
    signal_std: Vector
    variance_dn2: Vector
    variance_std: Vector
    in_fit: NDArray[np.bool_]
    is_clipped: NDArray[np.bool_]
    gain: float
    offset: float
    slope: float

    @classmethod
    def of(cls, sheet: Mapping[str, Any]) -> "Points":
        """Return those of `data-sheet.json`, in which an unknown number is null."""
        curve = sheet["curves"]["transfer"]
        exposed, photons = _numbers(curve["light"]), curve["photons"]
        offset, slope = _numbers(curve["line"])
        per_exposed = 1.0 if photons is None else float(_numbers(photons)[0] / exposed[0])
        gain = sheet["system_gain_dn_per_e"]["value"]
        return cls(
            light=per_exposed * exposed,
            light_name="exposure × level / µs" if photons is None else "photons per pixel",
            signal_dn=_numbers(curve["signal_dn"]),
            signal_std=_numbers(curve["signal_std"]),
            variance_dn2=_numbers(curve["variance_dn2"]),
            variance_std=_numbers(curve["variance_std"]),
            in_fit=np.asarray(curve["in_transfer"], dtype=np.bool_),
            is_clipped=_numbers(curve["share_at_full_scale"]) > _CLIPPED,
            gain=float("nan") if gain is None else float(gain),
            offset=float(offset),
            slope=float(slope / per_exposed),
        )


def mean_variance(points: Points) -> Figure:
    """Temporal variance against signal, and the straight line of the system gain."""
    line = straight(points.signal_dn, 0.0, points.gain, name=f"{points.gain:.4g} DN/e⁻")
    y, std = points.variance_dn2, points.variance_std
    flats = _split(points.in_fit, points.signal_dn, y, std)
    traces = [line, *flats] if np.isfinite(points.gain) else flats
    return figure(traces, x=_SIGNAL, y="σ² − σ²<sub>dark</sub><br>DN²", showlegend=True)


def mean_variance_residuals(points: Points) -> Figure:
    """What the line leaves of the variance, in percent of it; nothing of clipped flats."""
    line = points.gain * points.signal_dn
    left = _relative(points, points.variance_dn2, points.variance_std, line)
    return _residuals(_split(points.in_fit, points.signal_dn, *left), _SIGNAL)


def linearity(points: Points) -> Figure:
    """Signal against light, and the straight line of the least relative deviation."""
    line = straight(points.light, points.offset, points.slope, name="straight line")
    flats = _split(~points.is_clipped, points.light, points.signal_dn, points.signal_std)
    traces = [line, *flats] if np.isfinite(points.slope) else flats
    return figure(traces, x=points.light_name, y=_SIGNAL, showlegend=True)


def linearity_residuals(points: Points) -> Figure:
    """What the line leaves of the signal, in percent of it; nothing of clipped flats."""
    line = points.offset + points.slope * points.light
    left = _relative(points, points.signal_dn, points.signal_std, line)
    return _residuals(_split(~points.is_clipped, points.light, *left), points.light_name)


def _residuals(traces: list[dict[str, Any]], x: str) -> Figure:
    made = figure(traces, x=x, y="residual / %")
    made["layout"]["yaxis"].update(zeroline=True, zerolinecolor=SECOND, zerolinewidth=1.4)
    return made


def _relative(points: Points, value: Vector, std: Vector, line: Vector) -> tuple[Vector, Vector]:
    """Return residuals and their standard uncertainties in percent of `line`, with gaps."""
    there = np.where((line > 0) & ~points.is_clipped, line, np.nan)
    return 100.0 * (value / there - 1.0), 100.0 * std / there


def _split(used: NDArray[np.bool_], x: Vector, y: Vector, std: Vector) -> list[dict[str, Any]]:
    """Return flats that are used, then others, in grey and without a name in the legend."""
    kinds = ((used, "flats", FIRST), (~used, "left out", SOFT))
    return [
        dots(x[chosen], y[chosen], std[chosen], name=name, color=color)
        | {"showlegend": chosen is used}
        for chosen, name, color in kinds
        if chosen.any()
    ]


def _numbers(values: Any) -> Vector:
    return np.array([np.nan if each is None else each for each in values], dtype=np.float64)
