"""The transfer function of a folder with `mtf.toml`: of a grating's scan, or of an edge."""

from collections.abc import Callable
from pathlib import Path
from typing import Literal

from calib.mtf.edge.edge_result import EdgeResult
from calib.mtf.edge.reading import read_edge
from calib.mtf.measure import measure
from calib.mtf.reading import MtfToml, read_scan
from calib.mtf.result import TransferResult

Method = Literal["regularised", "filter"]
_READ = 0.05
"""The share of the time that reading the images takes."""


def of_grating(
    folder: Path,
    read: MtfToml,
    method: Method,
    support: int,
    *,
    progress: Callable[[float], None] = lambda _: None,
) -> TransferResult:
    """Reduce the scan of a grating; `progress` is called with the share that is done."""
    scan = read_scan(folder, read)
    progress(_READ)
    measured = measure(scan, method, support, lambda s: progress(_READ + (1 - _READ) * s))
    return TransferResult(measured, read.unknown_keys())


def of_edge(folder: Path, read: MtfToml) -> EdgeResult:
    """Reduce an edge's images: one direction alone."""
    return EdgeResult(*read_edge(folder, read))
