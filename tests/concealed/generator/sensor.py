"""A sensor that no catalogue lists, its nominal figures drawn at random."""

from dataclasses import dataclass

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from tests.concealed.generator.layout import TAPS, partner, registers, tap_map

Map = NDArray[np.float64]
"""(rows, columns)."""


@dataclass(frozen=True)
class Sensor:
    """What the camera is; nothing of what is hidden in its recording.

    Attributes:
        relative_response: PRNU times vignette, (rows, columns), largest about 1.
        offset_dn: DN at no light, (rows, columns).
        electrons_per_radiance_us: Where `relative_response` is 1.
    """

    rows: int
    columns: int
    area: bool
    bit_depth: int
    layout: str
    readout: str
    gain_dn_per_e: float
    read_noise_e: float
    full_well_e: float
    electrons_per_radiance_us: float
    relative_response: Map
    offset_dn: Map

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        return self.rows, self.columns

    @property
    def top_code(self) -> int:
        """The highest code."""
        return (1 << self.bit_depth) - 1

    @property
    def ceiling_e(self) -> float:
        """Electrons at which the pixel or the converter is full."""
        head_room = self.top_code - float(self.offset_dn.max())
        return min(self.full_well_e, head_room / self.gain_dn_per_e)

    @property
    def n_taps(self) -> int:
        """How many outputs."""
        return TAPS[self.layout]

    @property
    def taps(self) -> NDArray[np.intp]:
        """Tap of each pixel, (rows, columns)."""
        return tap_map(self.layout, self.rows, self.columns)

    @property
    def registers(self) -> list[NDArray[np.intp]]:
        """Columns of each register in the order in which they reach the output."""
        return registers(self.layout, self.readout, self.columns)

    @property
    def partner(self) -> NDArray[np.intp]:
        """The column read at the same moment by the neighbouring tap, (columns,)."""
        return partner(self.layout, self.readout, self.columns)


def draw_sensor(rng: Generator, *, area: bool, layout: str, bit_depth: int) -> Sensor:
    """Return a sensor of the wanted kind, everything else at random."""
    rows = int(rng.choice([8, 12, 16])) if area else 1
    columns = int(rng.choice([48, 64])) if area else int(rng.choice([256, 384, 512, 768]))
    top = (1 << bit_depth) - 1
    full_well_e = 10.0 ** rng.uniform(4.1, 4.9)
    offset = top * rng.uniform(0.015, 0.05) + max(4.0, 0.004 * top)
    gain = (top - offset) / (full_well_e * rng.uniform(0.85, 1.25))
    return Sensor(
        rows=rows,
        columns=columns,
        area=area,
        bit_depth=bit_depth,
        layout=layout,
        readout=_readout(rng, layout),
        gain_dn_per_e=gain,
        read_noise_e=max(rng.uniform(4.0, 25.0), rng.uniform(0.45, 0.9) / gain),
        full_well_e=full_well_e,
        electrons_per_radiance_us=10.0 ** rng.uniform(0.0, 2.0),
        relative_response=_response(rng, rows, columns),
        offset_dn=offset + _fixed_pattern(rng, layout, rows, columns, gain),
    )


def _readout(rng: Generator, layout: str) -> str:
    sides = ["both"] if layout in {"halves", "quadrants"} else ["left", "right"]
    return str(rng.choice(sides))


def _response(rng: Generator, rows: int, columns: int) -> Map:
    """Return a smooth vignette about an axis off the centre, times scatter of the pixels."""
    axis = columns * rng.uniform(0.42, 0.58)
    distance = (np.arange(columns) - axis) / (columns / 2)
    across = np.zeros(rows) if rows == 1 else np.linspace(-0.6, 0.6, rows)
    squared = distance**2 + across[:, np.newaxis] ** 2
    edge = rng.uniform(0.03, 0.22)
    profile = 1.0 - edge * (0.8 * squared + 0.2 * squared**2)
    prnu = 1.0 + rng.uniform(0.003, 0.012) * rng.standard_normal((rows, columns))
    return np.asarray(profile * prnu)


def _fixed_pattern(rng: Generator, layout: str, rows: int, columns: int, gain: float) -> Map:
    pixels = rng.uniform(3.0, 20.0) * gain * rng.standard_normal((rows, columns))
    steps = 10.0 * gain * rng.standard_normal(TAPS[layout])
    return np.asarray(pixels + steps[tap_map(layout, rows, columns)])
