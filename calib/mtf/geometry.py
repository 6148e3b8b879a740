"""Where pixels sample the pattern: tilt, stage positions, and how the real bench differs.

Contract §6: with s = pitch/√(m² + n²), the pixel at (row, col) in frame k samples the grating's
frame at x = s·(col·n − row·m + k), y = s·(col·m + row·n). The detector is tilted by α =
atan(m/n).
"""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import gcd
from typing import Self

import numpy as np
from numpy.typing import NDArray

from calib.errors import InputError

Vector = NDArray[np.floating]


def check_pitch(pitch_um: float) -> None:
    """Refuse a pixels' distance that cannot be, µm.

    Raises:
        InputError: `bad-pitch`.
    """
    if not (np.isfinite(pitch_um) and pitch_um > 0):
        msg = f"pitch_um = {pitch_um} cannot be: give the pixels' distance in µm"
        raise InputError(msg, code="bad-pitch")


@dataclass(frozen=True)
class Scan:
    """A tilted detector and one stage.

    Attributes:
        pitch_um: The pixels' distance, µm.
        m: Rows.
        n: Columns after which a row of the oversampled grid meets the detector's grid again.
    """

    pitch_um: float
    m: int
    n: int

    def __post_init__(self) -> None:
        check_pitch(self.pitch_um)
        if self.m < 0 or self.n < 0 or gcd(self.m, self.n) != 1:
            msg = f"m = {self.m} and n = {self.n} are not coprime, so that stage positions would"
            msg += " repeat each other: choose others, such as 1 and 6"
            raise InputError(msg, code="not-coprime")

    @property
    def positions(self) -> int:
        """K = m² + n² stage positions."""
        return self.m**2 + self.n**2

    @property
    def step_um(self) -> float:
        """s: the stage's step and the oversampled grid's pitch, µm."""
        return float(self.pitch_um / np.sqrt(self.positions))

    @property
    def tilt_rad(self) -> float:
        """α: the detector's nominal tilt, rad."""
        return float(np.arctan2(self.m, self.n))

    @property
    def nyquist_per_um(self) -> float:
        """The highest frequency that the oversampled grid carries, cycles per µm."""
        return 0.5 / self.step_um


@dataclass(frozen=True, eq=False)
class Alignment:
    """How the bench differs from its nominal geometry, about the detector's centre.

    Attributes:
        shift_um: Where the pattern lies, (x, y), in the grating's frame, µm.
        scale: The pattern's frequencies at the detector are 1 + scale times the nominal ones.
        tilt_rad: What the detector is tilted by beyond atan(m/n), rad.
        stage_um: Each frame's stage error (x, y), (n_frames, 2), µm.
    """

    shift_um: Vector = field(default_factory=lambda: np.zeros(2))
    scale: float = 0.0
    tilt_rad: float = 0.0
    stage_um: Vector | None = None


@dataclass(frozen=True, eq=False)
class Sampling:
    """Which points of the pattern which frames sample.

    Attributes:
        scan: The nominal geometry.
        n_rows: Of the detector.
        n_columns: Of the detector.
        frames: The stage positions k that there are.
        alignment: How the bench differs; stage errors are those of `frames`, in their order.
    """

    scan: Scan
    n_rows: int
    n_columns: int
    frames: tuple[int, ...]
    alignment: Alignment = field(default_factory=Alignment)

    @classmethod
    def whole(cls, scan: Scan, shape: tuple[int, int], alignment: Alignment | None = None) -> Self:
        """Return the sampling with all stage positions."""
        frames = tuple(range(scan.positions))
        return cls(scan, *shape, frames, alignment or Alignment())

    def aligned(self, alignment: Alignment) -> "Sampling":
        """Return the same frames on another bench."""
        return replace(self, alignment=alignment)

    @cached_property
    def stage_um(self) -> Vector:
        """Each frame's displacement, errors included, (n_frames, 2), µm."""
        nominal = np.zeros((len(self.frames), 2))
        nominal[:, 0] = self.scan.step_um * np.array(self.frames)
        errors = self.alignment.stage_um
        return nominal if errors is None else nominal + errors

    @property
    def centre_um(self) -> Vector:
        """The detector's centre at stage position 0, nominal, (x, y) in µm."""
        row, column = (self.n_rows - 1) / 2, (self.n_columns - 1) / 2
        m, n = self.scan.m, self.scan.n
        centre: Vector = self.scan.step_um * np.array(
            [column * n - row * m, column * m + row * n], np.float64
        )
        return centre

    def to_detector(self, frequency_per_um: Vector) -> Vector:
        """Turn frequencies (n, 2) of the grating's frame into the detector's: fx along columns."""
        tilt = self.scan.tilt_rad + self.alignment.tilt_rad
        cos, sin = np.cos(tilt), np.sin(tilt)
        turned: Vector = frequency_per_um @ np.array([[cos, -sin], [sin, cos]])
        return (1 + self.alignment.scale) * turned

    @cached_property
    def row(self) -> Vector:
        """Rows counted from the detector's centre, (n_rows,)."""
        return np.arange(self.n_rows) - (self.n_rows - 1) / 2

    @cached_property
    def column(self) -> Vector:
        """Columns counted from the detector's centre, (n_columns,)."""
        return np.arange(self.n_columns) - (self.n_columns - 1) / 2

    def positions_um(self) -> Iterator[Vector]:
        """Yield the sampled points of each frame, (2, n_rows, n_columns): x and y in µm."""
        tilt = self.scan.tilt_rad + self.alignment.tilt_rad
        size = self.scan.pitch_um * (1 + self.alignment.scale)
        row, column = size * self.row[:, None], size * self.column[None, :]
        x = np.cos(tilt) * column - np.sin(tilt) * row
        y = np.sin(tilt) * column + np.cos(tilt) * row
        for stage in self.stage_um:
            at = self.centre_um + stage - self.alignment.shift_um
            yield np.stack([x + at[0], y + at[1]])
