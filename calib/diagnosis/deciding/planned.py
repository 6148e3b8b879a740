"""The evidence that a plan would give, from the fitted baseline alone: nothing is recorded for it.

A planned block gives what the baseline expects of it: means of fitted offsets and slopes, variances
of fitted gain and read noise. With the blocks recorded so far it makes one evidence, in which the
plan's lines whiten differences as those of the recording do, and offsets and slopes are common.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.baseline.baseline import CLEAR_SIGMA, Baseline
from calib.diagnosis.baseline.expected_codes import MOST_PIXELS
from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.evidence.growing import Growing
from calib.diagnosis.recorded.conditions_table import ConditionsTable
from calib.diagnosis.recorded.sensor import Sensor
from calib.diagnosis.statistics.block_sums import BlockSums
from calib.diagnosis.statistics.peak import Peak
from calib.diagnosis.statistics.rare import RareEvents
from calib.forward.scene import bar
from calib.kernels.expected_histogram import expected_histogram
from calib.kernels.residual_products import COLUMN_LAGS, LINE_LAGS, ResidualProducts
from calib.recording.header import Block

Floats = NDArray[np.float64]


def with_planned(evidence: Evidence, blocks: Sequence[Block]) -> Evidence:
    """Return the evidence of what was recorded and of `blocks`, which all tell their start."""
    if not blocks:
        return evidence
    table = _with_blocks(evidence.table, blocks)
    base = _with_means(evidence.baseline, table, evidence.sensor)
    first = len(evidence.sums)
    new = [
        expected_sums(b, base, table, evidence.sensor) for b in range(first, first + len(blocks))
    ]
    sums = (*evidence.sums, *new)
    peaks = tuple(_not_looked_for(peak, len(blocks)) for peak in evidence.peaks)
    growing = None if evidence.growing is None else _as_expected(evidence.growing, base, first)
    return replace(
        evidence,
        sums=sums,
        table=table,
        baseline=base,
        whole=None,
        known_peaks=peaks,
        growing=growing,
    )


def _as_expected(growing: Growing, base: Baseline, first: int) -> Growing:
    """Return pixels that grow, with the baseline's noise in the blocks from `first` on."""
    planned = base.variance_dn2[first:].reshape(len(base.variance_dn2) - first, -1)
    variance = np.concatenate([growing.variance_dn2, planned[:, growing.pixels]])
    return replace(growing, variance_dn2=variance)


def _not_looked_for(peak: Peak, n_blocks: int) -> Peak:
    """Return a recording's tone, of which the planned blocks tell nothing."""
    return replace(
        peak,
        squared_amplitude_dn2=peak.squared_amplitude_dn2 + (0.0,) * n_blocks,
        std_dn2=peak.std_dn2 + (np.inf,) * n_blocks,
    )


def _with_blocks(table: ConditionsTable, blocks: Sequence[Block]) -> ConditionsTable:
    lines = [float(block.lines or 1) for block in blocks]
    last = table.sessions[-1:] * len(blocks)
    radiance = [_radiance(table, block) for block in blocks]
    first, columns = len(table.blocks), table.camera.columns
    seen = np.broadcast_to(bar(columns), (table.camera.rows or 1, columns)).ravel()
    scenes = {first + k: seen * radiance[k] for k, b in enumerate(blocks) if b.kind == "scene"}
    names = {block.scene for block in blocks if block.scene is not None}
    return replace(
        table,
        blocks=(*table.blocks, *blocks),
        radiance=np.concatenate([table.radiance, radiance]),
        started_s=np.concatenate([table.started_s, [float(b.started_s or 0.0) for b in blocks]]),
        n_lines=np.concatenate([table.n_lines, lines]),
        scenes={**table.scenes, **scenes},
        estimated=table.estimated | names,
        sessions=(*table.sessions, *last),
    )


def _radiance(table: ConditionsTable, block: Block) -> float:
    """Return the radiance of a level as the recording has it, else in proportion."""
    if block.kind == "dark":
        return 0.0
    flats = np.array([b.kind == "flat" for b in table.blocks])
    known = table.radiance[(table.level == block.level) & flats]
    if len(known):
        return float(known.mean())
    lit = (table.level > 0) & flats
    return float(block.level * (table.radiance[lit] / table.level[lit]).mean())


def _with_means(base: Baseline, table: ConditionsTable, sensor: Sensor) -> Baseline:
    old, dose = len(base.mean_dn), table.dose_of((sensor.n_rows, sensor.n_columns))
    signal = base.slope * dose[old:]
    read, gain = base.read_variance_dn2[sensor.tap], base.gain_dn_per_e[sensor.tap]
    mean = base.offset_dn + signal
    variance = np.maximum(read + gain * signal, 0.3 * read)
    reach = CLEAR_SIGMA * np.sqrt(variance) + 0.5
    usable = (mean > reach) & (mean < sensor.camera.full_scale_dn - reach)
    return replace(
        base,
        dose=dose,
        mean_dn=np.concatenate([base.mean_dn, mean]),
        variance_dn2=np.concatenate([base.variance_dn2, variance]),
        usable=np.concatenate([base.usable, usable]),
    )


def expected_sums(b: int, base: Baseline, table: ConditionsTable, sensor: Sensor) -> BlockSums:
    """Return what a block of exactly the expected moments would have left behind."""
    n, shape = int(table.n_lines[b]), base.mean_dn[b].shape
    variance = base.variance_dn2[b]
    nothing = np.zeros(shape)
    products = ResidualProducts(
        nothing, variance * (n - 1), 3.0 * variance**2 * n, np.zeros((COLUMN_LAGS, *shape)),
        nothing, np.zeros((LINE_LAGS, *shape)), np.zeros((len(sensor.partner), *shape)),
        np.zeros((n, sensor.n_rows, sensor.n_taps)), np.zeros(shape, np.int64),
    )  # fmt: skip
    return BlockSums(
        n, base.mean_dn[b], nothing, variance, products, np.sqrt(variance), RareEvents.none(),
        np.stack([_by_code(n, base.mean_dn[b], variance, sensor.tap == tap, sensor)
                  for tap in range(sensor.n_taps)]),
        np.zeros((1, 1), np.float32), 0,
    )  # fmt: skip


def _by_code(
    n: int, mean: Floats, variance: Floats, of_tap: NDArray[np.bool_], sensor: Sensor
) -> NDArray[np.int64]:
    """Return how often a tap's pixels are expected to give each code, (n_codes,)."""
    step = max(1, int(of_tap.sum()) // MOST_PIXELS)
    some, std = mean[of_tap][::step], np.sqrt(variance[of_tap][::step])
    counts = expected_histogram(some, std, float(n * step), sensor.camera.full_scale_dn + 1)
    return np.round(counts).astype(np.int64)
