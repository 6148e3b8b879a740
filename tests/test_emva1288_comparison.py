"""The comparison's camera is one that the data sheet can be made of, whatever the peer says."""

from pathlib import Path

import numpy as np

from benchmarks.emva1288_comparison import ROWS, draw, table
from calib.recording.open import open_recording
from calib.transfer.emva1288.data_sheet import data_sheet


def test_a_row_each_with_the_difference_in_our_uncertainties(tmp_path: Path) -> None:
    draw(tmp_path, (32, 40), np.random.default_rng(1))
    sheet = data_sheet(open_recording(tmp_path))
    theirs = {row.theirs: 0.0 for row in ROWS}
    lines = table(sheet, theirs)[2:]
    assert len(lines) == len(ROWS)
    gain = sheet["system_gain_dn_per_e"]
    assert f"{-gain.value / gain.std:+.2f}" in lines[0]
    assert abs(gain.value - 0.25 * (1 - 0.02)) < 5 * gain.std + 0.02 * 0.25  # it bends by 1 %
