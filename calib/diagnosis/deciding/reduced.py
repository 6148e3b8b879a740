"""A smaller sensor for the search among plans: separations grow as the root of the pixels.

A window of the columns (and rows) stands for all of them, with the baseline's own values there. An
effect that grows along a register is taken as it is near its output, which promises too little.
"""

from dataclasses import replace

import numpy as np

from calib.diagnosis.baseline.baseline import Baseline
from calib.diagnosis.deciding.planned import expected_sums
from calib.diagnosis.deciding.rivals import Rivals
from calib.diagnosis.deciding.window import Window
from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.recorded.sensor import Sensor
from calib.diagnosis.statistics.counts import Counts

MOST_COLUMNS, MOST_ROWS = 512, 8


def reduced(
    rivals: Rivals, evidence: Evidence, columns: int = MOST_COLUMNS
) -> tuple[Rivals, Evidence, float]:
    """Return rivals and what the baseline expects on a window, and by which factor sigmas grow."""
    camera = evidence.sensor.camera
    rows = camera.rows and min(camera.rows, MOST_ROWS)
    if camera.columns <= columns and rows == camera.rows:
        return rivals, evidence, 1.0
    # The middle; whole groups of taps.
    width = min(columns, camera.columns)
    first = (camera.columns - width) // 2 // 4 * 4
    smaller = camera.model_copy(update={"columns": width, "rows": rows})
    sensor, table = Sensor(smaller), evidence.table
    whole = (evidence.sensor.n_rows, evidence.sensor.n_columns)
    window = Window(whole, (slice(None, rows), slice(first, first + width)))
    scenes = {b: image.ravel()[window.pixels] for b, image in table.scenes.items()}
    small = replace(table, camera=smaller, scenes=scenes)
    base = _cut(evidence.baseline, window.at)
    sums = tuple(expected_sums(b, base, small, sensor) for b in range(len(table.blocks)))
    found = Evidence(sums, small, sensor, base, Counts.of(sensor), evidence.common)
    return window.of(rivals), found, float(np.sqrt(evidence.sensor.n_pixels / sensor.n_pixels))


def _cut(base: Baseline, window: tuple[slice, slice]) -> Baseline:
    at = (..., *window)
    return replace(
        base,
        offset_dn=base.offset_dn[at],
        slope=base.slope[at],
        dose=base.dose[at],
        mean_dn=base.mean_dn[at],
        variance_dn2=base.variance_dn2[at],
        usable=base.usable[at],
    )
