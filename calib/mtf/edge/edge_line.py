"""Where an edge crosses each row, and the straight line through that."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.errors import NotDeterminedError

Vector = NDArray[np.floating]
_HALF_WIDTH = 6.0
_PASSES = 3
_LEAST_ROWS = 3
_BESIDE = 0.05  # of the rows: noise may halve a step so often
_LEAST_TRAVEL = 1.0
_END = 3  # columns at each end, whose difference is the step
_SURE = 8.0  # standard errors of the rows' mean step


@dataclass(frozen=True)
class EdgeLine:
    """column = start + slope · row.

    Attributes:
        start: Column at row 0.
        slope: Columns per row.
    """

    start: float
    slope: float

    def at(self, row: Vector) -> Vector:
        """Return the column at each row."""
        return self.start + self.slope * row


def find_edge(image: Vector) -> EdgeLine:
    """Find the edge that crosses the columns: ISO 12233's centroid of each row's derivative.

    Raises:
        NotDeterminedError: `no-edge`; `edge-at-border`; or `no-slant` where it crosses less than
            one column over all rows, so that its flank is not sampled finely.
    """
    if len(image) < _LEAST_ROWS:
        raise _no_slant()
    derivative = np.gradient(image, axis=1)
    derivative *= np.sign(derivative.sum())
    rows, columns = np.arange(len(image), dtype=float), np.arange(image.shape[1], dtype=float)
    step = image[:, -_END:].mean(axis=1) - image[:, :_END].mean(axis=1)
    if abs(step.mean()) <= _SURE * step.std() / np.sqrt(len(step)):
        msg = "no edge crosses the columns: show one edge, dark on one side and lit on the other"
        raise NotDeterminedError(msg, code="no-edge")
    _check_rows(np.abs(step))
    smooth = np.array([np.convolve(row, np.ones(5), "same") for row in derivative])
    line = np.polyfit(rows, columns[smooth.argmax(axis=1)], 1)
    for _ in range(_PASSES):
        away = columns - np.polyval(line, rows)[:, None]
        inside = np.cos(np.pi / 2 * np.clip(away / _HALF_WIDTH, -1, 1)) ** 2 * derivative
        line = np.polyfit(rows, (inside * columns).sum(1) / inside.sum(1), 1)
    if abs(line[0]) * len(image) < _LEAST_TRAVEL:
        raise _no_slant()
    return EdgeLine(float(line[1]), float(line[0]))


def _check_rows(step: Vector) -> None:
    """Refuse an image of which many rows show less than half of the edge's step."""
    beside = int((step < 0.5 * np.quantile(step, 0.9)).sum())
    if beside > _BESIDE * len(step):
        msg = f"the edge is not inside the image in {beside} of {len(step)} rows: cut the image to"
        raise NotDeterminedError(f"{msg} where it is", code="edge-at-border")


def _no_slant() -> NotDeterminedError:
    msg = "the edge crosses less than one column over all rows: slant it by about five degrees"
    return NotDeterminedError(msg, code="no-slant")
