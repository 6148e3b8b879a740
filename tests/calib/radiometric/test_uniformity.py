from dataclasses import replace

import numpy as np
import pytest

from calib.radiometric.uniformity import held_out_lines, nearest_to_half_scale, uniformity
from calib.recording.block_statistics import BlockStatistics
from calib.recording.header import Block, CameraHeader, RecordingHeader
from calib.recording.statistics import column_statistics
from tests.calib.radiometric.example_set import example_set
from tests.calib.radiometric.in_memory import InMemory

NONE = np.zeros(32, np.int64)


def statistics(mean: float, name: str = "1", kind: str = "flat") -> BlockStatistics:
    block = Block(block=name, kind=kind, exposure_us=100.0)  # type: ignore[arg-type]
    return BlockStatistics(block, 8, np.full(32, mean), np.ones(32), NONE, NONE)


@pytest.mark.parametrize("every", [2, 5, 8])
def test_the_lines_looked_at_are_those_that_the_statistics_hold_out(every: int) -> None:
    rng = np.random.default_rng()
    frames = tuple(rng.integers(0, 4096, (n, 32), dtype=np.uint16) for n in (7, 1, 20, 13))
    header = RecordingHeader(
        camera=CameraHeader(columns=32, bit_depth=12),
        blocks=(Block(block="0", kind="flat", exposure_us=100.0),),
    )
    recording = InMemory(header, {"0": frames})
    held_out = column_statistics(recording, held_out_every=every).held_out[0]
    lines = np.vstack(list(held_out_lines(recording.frames("0"), every)))
    assert len(lines) == held_out.n_lines
    np.testing.assert_allclose(lines.mean(axis=0), held_out.mean_dn)


def test_the_flat_nearest_to_half_of_full_scale_is_judged() -> None:
    dark = statistics(2047.0, "d", "dark")
    found = nearest_to_half_scale([dark, statistics(500), statistics(1900, "2")], 4095)
    assert found is not None
    assert found.block.block == "2"
    assert nearest_to_half_scale([dark], 4095) is None


def test_a_perfect_correction_leaves_no_variation_of_a_uniform_source() -> None:
    n = 32
    responsivity = 0.2 * (1 + 0.03 * np.sin(np.arange(n)))
    shape = example_set().vignette
    coefficients = example_set(
        responsivity=responsivity,
        slope=responsivity * shape,
        reason=np.zeros(n, np.uint8),
    )
    flat = replace(statistics(0.0), mean_dn=30.0 + 90.0 * responsivity * shape * 100.0)
    found = uniformity(coefficients, flat)
    scatter = 100 * responsivity.std(ddof=1) / responsivity.mean()
    assert found.after == pytest.approx(0.0, abs=1e-9)
    assert found.before_offset_removed == pytest.approx(scatter)
    assert found.before_single_line is None


def test_the_median_over_single_lines_is_not_pulled_by_one_bad_line() -> None:
    whole = np.full(32, 0.2)
    coefficients = example_set(
        reason=np.zeros(32, np.uint8), responsivity=whole, slope=whole * example_set().vignette
    )
    line = 30.0 + 90.0 * coefficients.slope * 100.0
    lines = np.rint(np.tile(line, (9, 1))).astype(np.uint16)
    lines[4, ::2] = 0
    found = uniformity(coefficients, replace(statistics(0.0), mean_dn=line), [lines[:3], lines[3:]])
    assert found.after_single_line is not None
    assert found.after_single_line < 0.1
