"""A pixel's transfer function: its modulus (MTF) and phase (PTF) along both axes, its map."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from service.page.figures.plot import FIRST, SECOND, SOFT, Figure, banded, figure, packed

Vector = NDArray[np.floating]
Arrays = Mapping[str, NDArray[Any]]
_SURE: Final = 3.0
"""A phase is shown where the modulus is so many of its standard uncertainties above 0."""


@dataclass(frozen=True, eq=False)
class Cut:
    """A transfer function along one axis of the detector, arrays (n,); NaN where unknown.

    Attributes:
        axis: "x" along the columns, "y" along the rows.
        frequency_per_mm: From 0 on, cycles per mm.
        transfer: Complex, 1 at 0.
        real_std: Standard uncertainty of its real part.
        imaginary_std: Of its imaginary part.
    """

    axis: str
    frequency_per_mm: Vector
    transfer: NDArray[np.complex128]
    real_std: Vector
    imaginary_std: Vector

    @property
    def modulus_std(self) -> Vector:
        """Of |T|, both parts taken as independent (GUM, 5.1.2)."""
        real, imaginary = (
            self.transfer.real * self.real_std,
            self.transfer.imag * self.imaginary_std,
        )
        return np.asarray(np.hypot(real, imaginary) / np.abs(self.transfer))

    @property
    def phase_std_deg(self) -> Vector:
        """Of the angle of T, likewise, degrees."""
        across = np.hypot(
            self.transfer.imag * self.real_std, self.transfer.real * self.imaginary_std
        )
        return np.asarray(np.degrees(across / np.abs(self.transfer) ** 2))


def cuts(arrays: Arrays, metadata: Mapping[str, Any]) -> tuple[Cut, ...]:
    """Return those of `transfer-function.h5`: of a grating two, of an edge one."""
    frequency, transfer = arrays["frequency_per_mm"], arrays["transfer"]
    start = int(np.argmin(np.abs(frequency)))  # holds 0
    if transfer.ndim == 1:
        # The file has the uncertainty of the complex number: half of its variance in either part.
        part = arrays["transfer_std"] / np.sqrt(2.0)
        return (Cut(str(metadata["direction"]), frequency, transfer, part, part),)
    parts = [arrays[name] for name in ("transfer", "transfer_real_std", "transfer_imaginary_std")]
    along_x, along_y = (start, slice(start, None)), (slice(start, None), start)
    return tuple(
        Cut(axis, frequency[start:], *(part[where] for part in parts))
        for axis, where in (("x", along_x), ("y", along_y))
    )


def modulus(found: Sequence[Cut], pitch_um: float) -> Figure:
    """MTF along each axis with its band (k = 2); a line at Nyquist's frequency."""
    traces = [t for cut in found for t in _banded(cut, np.abs(cut.transfer), cut.modulus_std)]
    nyquist = 500.0 / pitch_um
    traces.append(
        {
            "x": [nyquist, nyquist],
            "y": [0.0, 1.0],
            "mode": "lines",
            "line": {"color": SOFT, "width": 1, "dash": "dot"},
            "name": f"Nyquist {nyquist:.4g}",
        }
    )
    return figure(traces, x="cycles per mm", y="MTF = |T|", showlegend=True)


def phase(found: Sequence[Cut]) -> Figure:
    """PTF along each axis with its band (k = 2); gaps where the modulus is hardly above 0."""
    traces = []
    for cut in found:
        is_sure = np.abs(cut.transfer) > _SURE * cut.modulus_std
        angle = np.where(is_sure, np.degrees(np.angle(cut.transfer)), np.nan)
        traces += _banded(cut, angle, cut.phase_std_deg)
    return figure(traces, x="cycles per mm", y="PTF = arg T / °", showlegend=True)


def transfer_map(arrays: Arrays) -> Figure:
    """The real part, with its signs, over both frequencies; blank where it is not determined."""
    at = arrays["frequency_per_mm"]
    return _square(arrays["transfer"].real, at, "f<sub>{}</sub>, cycles per mm", "Re T", 1.0)


def point_spread(arrays: Arrays) -> Figure:
    """The point-spread function, ∫ = 1; blue where noise takes it below 0."""
    psf = arrays["psf"]
    return _square(psf, arrays["position_um"], "{} / µm", "1/µm²", float(np.nanmax(psf)))


def line_spread(arrays: Arrays) -> Figure:
    """What an edge shows of the point spread: its integral along the edge."""
    line = {
        "x": packed(arrays["position_um"]),
        "y": packed(arrays["line_spread"]),
        "mode": "lines",
        "line": {"color": FIRST, "width": 1.4},
        "name": "line spread",
    }
    return figure([line], x="position / µm", y="line spread / (1/µm)")


def _banded(cut: Cut, y: Vector, std: Vector) -> list[dict[str, Any]]:
    """Return a line with its band; dashed along y, so that one does not hide the other."""
    color, dash = (FIRST, "solid") if cut.axis == "x" else (SECOND, "dash")
    *edges, line = banded(cut.frequency_per_mm, y, std, name=f"along {cut.axis}", color=color)
    return [*edges, {**line, "line": {**line["line"], "dash": dash}}]


def _square(z: Vector, at: Vector, axis: str, unit: str, highest: float) -> Figure:
    """Draw a map of as many rows as columns; colours are symmetric about 0."""
    picture = {
        "type": "heatmap",
        "z": packed(z),
        "x": packed(at),
        "y": packed(at),
        "colorscale": "RdBu",
        "zmin": -highest,
        "zmax": highest,
        "colorbar": {"title": {"text": unit}, "thickness": 12, "outlinewidth": 0},
    }
    made = figure([picture], x=axis.format("x"), y=axis.format("y"))
    made["layout"]["yaxis"].update(scaleanchor="x", constrain="domain")
    made["layout"]["xaxis"]["constrain"] = "domain"
    return made
