"""Which part of a sensor a plan reads out."""

from dataclasses import dataclass
from typing import cast

import numpy as np

from calib.arrays import RawLines
from calib.errors import InputError
from calib.recording.header import CameraHeader
from service.plan.camera import PlanCamera


@dataclass(frozen=True)
class Region:
    """Columns from a first one on; of an area sensor rows, too.

    Attributes:
        n_rows: None of a line sensor.
    """

    first_column: int
    n_columns: int
    first_row: int = 0
    n_rows: int | None = None

    @classmethod
    def of(cls, wanted: PlanCamera, sensor: CameraHeader) -> "Region":
        """Return the region of `sensor` that is `wanted`; InputError where it is too small."""
        _check("column", wanted.first_column, wanted.columns, sensor.columns)
        _check("row", wanted.first_row, wanted.rows, sensor.rows or 0)
        rows = None if sensor.rows is None else wanted.rows or sensor.rows - wanted.first_row
        columns = wanted.columns or sensor.columns - wanted.first_column
        return cls(wanted.first_column, columns, wanted.first_row, rows)

    def cut(self, dn: RawLines) -> RawLines:
        """Return the region of lines, or of an area sensor's frames, as an array of its own."""
        part = dn[..., self.first_column : self.first_column + self.n_columns]
        if self.n_rows is not None:
            part = part[:, self.first_row : self.first_row + self.n_rows]
        return cast("RawLines", np.ascontiguousarray(part))


def _check(what: str, first: int, wanted: int | None, there: int) -> None:
    last = first + (wanted or max(there - first, 0))
    if last > there:
        msg = (
            f"the plan reads {what}s up to {last}, but the model's camera has {there}:"
            f" lower camera.{what}s or camera.first_{what} in the plan"
        )
        raise InputError(msg, code="plan-does-not-fit-model")
