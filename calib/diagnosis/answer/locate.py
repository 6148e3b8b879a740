"""Where an effect, or a remainder, lives: statistic, blocks, columns, in words."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.answer.finding import Where
from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.evidence.point import Point

Floats = NDArray[np.float64]

SHARE = 0.9
"""The blocks and columns that are named hold this much of what is seen."""
MOST_BLOCKS = 8
_STATISTICS = {
    "mean": "the means of blocks",
    "variance": "the noise of single pixels",
    "column_covariance": "what neighbouring columns have in common",
    "line_covariance": "what successive lines have in common",
    "spectrum": "the rhythm of the lines",
    "histogram": "how often codes occur",
    "tail": "single samples that stand out",
    "transient": "the first lines after a change",
}
_VARIABLES = {
    "signal": "the signal",
    "exposure": "the exposure time",
    "level": "the lamps' level",
    "time": "wall time",
    "temperature": "the sensor's temperature",
    "column": "the column",
    "tap": "the tap",
    "line": "the line",
    "code": "the code",
    "previous_block": "the block before",
}


def locate(point: Point, statistic: str, depends_on: Sequence[str], evidence: Evidence) -> Where:
    """Return where a whitened contribution lives."""
    n = evidence.pooled.std.size
    by_block = (point.means**2).sum(axis=1)
    by_block = by_block + (point.rest[:n].reshape(evidence.pooled.std.shape) ** 2).sum(axis=1)
    columns = columns_of((point.means**2).sum(axis=0), evidence)
    return where(statistic, depends_on, by_block, columns, evidence)


def where(
    statistic: str,
    depends_on: Sequence[str],
    by_block: Floats,
    columns: tuple[int, int],
    evidence: Evidence,
) -> Where:
    """Return the place in words, too."""
    return placed(statistic, depends_on, by_block, columns, evidence.table.names)


def placed(
    statistic: str,
    depends_on: Sequence[str],
    by_block: Floats,
    columns: tuple[int, int],
    names: Sequence[str],
) -> Where:
    """Return the place in words, too, among blocks of those names."""
    order = np.argsort(by_block)[::-1]
    total = max(float(by_block.sum()), 1e-300)
    count = int(np.searchsorted(np.cumsum(by_block[order]) / total, SHARE)) + 1
    chosen = sorted(int(b) for b in order[: min(count, MOST_BLOCKS)]) if total > 1e-299 else []
    blocks = tuple(names[b] for b in chosen)
    follows = " and ".join(_VARIABLES.get(v, v) for v in depends_on)
    text = f"Seen in {_STATISTICS.get(statistic, statistic)}; it follows {follows}."
    if blocks:
        text += f" Strongest in block {_listed(blocks)}."
    return Where(statistic, tuple(depends_on), columns, blocks, text)


def _listed(names: Sequence[str]) -> str:
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"


def columns_of(energy: Floats, evidence: Evidence) -> tuple[int, int]:
    """Return the first and last column between which the middle of the energy lies."""
    by_column = energy.reshape(evidence.sensor.n_rows, -1).sum(axis=0)
    total = float(by_column.sum())
    if total <= 0:
        return 0, evidence.sensor.n_columns - 1
    cumulated = np.cumsum(by_column) / total
    first = int(np.searchsorted(cumulated, 0.5 * (1 - SHARE)))
    last = int(np.searchsorted(cumulated, 0.5 * (1 + SHARE)))
    if last - first > 0.8 * (len(by_column) - 1):
        return 0, len(by_column) - 1
    return first, last
