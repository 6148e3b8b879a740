"""What is said of a correction is true of lines whose truth is known."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from numpy.random import default_rng
from numpy.typing import NDArray

from calib.arrays import RawLines
from calib.errors import InputError
from calib.recording.header import Block, RecordingHeader
from service.evaluation.corrected_block import (
    MOST_LINES,
    block_in_the_middle,
    blocks_to_show,
    corrected_block,
)
from tests.calib.radiometric.example_set import example_set

SET = example_set(500)
FLAT = Block(block="000", kind="flat", exposure_us=300.0, level=2.0)
RADIANCE = 50.0
FRAME_LINES = 60


@dataclass(frozen=True)
class Drawn:
    """A recording of one block, whose frames are cut from `lines`."""

    header: RecordingHeader
    lines: RawLines
    path: Path = Path("drawn.h5")
    warnings: tuple[str, ...] = ()

    def frames(self, block: str) -> Iterator[RawLines]:
        for first in range(0, len(self.lines), FRAME_LINES):
            yield self.lines[first : first + FRAME_LINES]

    def digest(self) -> str:
        return "0" * 64


def drawn(n_lines: int, *, prnu: NDArray[np.floating] | float = 0.0) -> Drawn:
    """Draw lines of one radiance as `SET` has them, but for a `prnu` that it does not know."""
    slope = np.nan_to_num(SET.slope, nan=0.0)
    signal = slope * (1.0 + prnu) * FLAT.exposure_us * RADIANCE
    gain = SET.system_gain_dn_per_e
    variance = gain * signal + (gain * SET.read_noise_e) ** 2
    lines = default_rng().normal(SET.dark_offset_dn + signal, np.sqrt(variance), (n_lines, 500))
    header = RecordingHeader(camera=SET.camera, blocks=(FLAT,))
    return Drawn(header, np.rint(lines).astype(np.uint16))


@pytest.mark.parametrize("prnu_percent", [0.0, 1.0])
def test_what_is_left_is_noise_and_what_the_set_does_not_know(prnu_percent: float) -> None:
    pattern = default_rng().normal(size=500)
    pattern = (pattern - pattern.mean()) / pattern.std(ddof=1)
    recording = drawn(200, prnu=0.01 * prnu_percent * pattern)
    found = corrected_block(recording, SET, FLAT, is_own=False)
    left = np.hypot(found.noise_percent, prnu_percent)
    # A standard deviation over n columns scatters by 1/√(2(n − 1)) of itself.
    assert abs(found.after.mean_line / left - 1.0) < 4.5 / np.sqrt(2 * 498)
    # Before it is the shape of VE, 15 %; noise of 0.05 % moves that by 0.05/15/√499 = 1.5e-4.
    signal = SET.slope * (1.0 + 0.01 * prnu_percent * pattern) * FLAT.exposure_us * RADIANCE
    seen = (SET.dark_offset_dn + signal)[found.used]
    expected = 100.0 * seen.std(ddof=1) / seen.mean()
    assert found.before.mean_line == pytest.approx(expected, rel=4.5 * 1.5e-4)
    assert found.without_vignette.mean_line < found.before.mean_line
    assert found.after.single_line > found.after.mean_line


def test_dead_and_saturated_columns_are_left_out() -> None:
    recording = drawn(40)
    recording.lines[7, 100] = 4095
    found = corrected_block(recording, SET, FLAT, is_own=False)
    assert np.flatnonzero(~found.used).tolist() == [3, 100]
    assert np.isfinite(found.after.mean_line)


def test_lines_are_the_first_ones_or_those_that_the_fit_did_not_use() -> None:
    recording = drawn(MOST_LINES + 70)
    others = corrected_block(recording, SET, FLAT, is_own=False).raw_dn
    np.testing.assert_array_equal(others, recording.lines[:MOST_LINES])
    own = corrected_block(recording, SET, FLAT, is_own=True).raw_dn
    np.testing.assert_array_equal(own, recording.lines[7::8])


def test_what_cannot_be_shown_is_refused() -> None:
    recording = drawn(9)
    header = recording.header
    area = header.model_copy(update={"camera": SET.camera.model_copy(update={"rows": 9})})
    other = header.model_copy(update={"camera": SET.camera.model_copy(update={"serial": "X"})})
    full = np.full_like(recording.lines, 4095)
    for wrong, is_own, code in (
        (recording, True, "too-few-lines"),
        (replace(recording, header=area), False, "area-sensor"),
        (replace(recording, header=other), False, "set-mismatch"),
        (replace(recording, lines=full), False, "all-saturated"),
    ):
        with pytest.raises(InputError) as refused:
            corrected_block(wrong, SET, FLAT, is_own=is_own)
        assert refused.value.code == code


def test_a_lit_block_in_the_middle_is_shown_first() -> None:
    made = [
        FLAT.model_copy(update={"block": f"{k:03d}", "exposure_us": exposure, "kind": kind})
        for k, (exposure, kind) in enumerate(
            [(900.0, "flat"), (100.0, "flat"), (500.0, "scene"), (500.0, "dark")]
        )
    ]
    header = RecordingHeader(camera=SET.camera, blocks=tuple(made))
    lit = blocks_to_show(Drawn(header, np.zeros((0, 500), np.uint16)))
    assert [each.block for each in lit] == ["000", "001", "002"]
    assert block_in_the_middle(lit).block == "002"
