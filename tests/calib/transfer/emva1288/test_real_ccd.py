"""A real 12-bit CCD, and what EMVA's own group printed of it."""

import csv
from pathlib import Path

import numpy as np
import pytest

from calib.recording.open import open_recording
from calib.transfer.emva1288.data_sheet import data_sheet
from calib.transfer.emva1288.sheet import DataSheet

TABLE = Path(__file__).parents[4].parent / "shared/data/real/emva1288_ccd12/ptc_table.csv"
PIXELS = 640 * 480
PUBLISHED = {
    # GitHub EMVA1288/emva1288, doc/datasets/datasets_results.rst
    "system_gain_dn_per_e": 0.280769280926,
    "inverse_system_gain_e_per_dn": 3.56164319936,
    "temporal_dark_noise_dn": 3.07341849276,
    "read_noise_e": 10.8980275235,
}
PUBLISHED_IN_PHOTONS = {
    "responsivity_dn_per_photon": 0.126726922819,
    "quantum_efficiency": 0.451356082834,
    "saturation_capacity_photons": 30957.0,
    "saturation_capacity_e": 13972.6302563,
    "snr_max": 118.205880802,
}
pytestmark = [
    pytest.mark.shared,
    pytest.mark.skipif(not TABLE.exists(), reason="needs the reference material"),
]


@pytest.fixture(scope="module")
def sheet(tmp_path_factory: pytest.TempPathFactory) -> DataSheet:
    lines = [line for line in TABLE.read_text().splitlines() if not line.startswith("#")]
    steps = list(csv.DictReader(lines))
    last = steps[-1]
    rate = float(last["photons_per_pixel"]) / float(last["texp_ns"]) * 1e3
    folder = tmp_path_factory.mktemp("ccd")
    (folder / "recording.toml").write_text(
        '[camera]\nmodel = "CCD"\ncolumns = 640\nrows = 480\nbit_depth = 12\n[source]\n'
        f'kind = "led"\nwavelength_nm = 520.0\nphotons_per_pixel_per_us = {rate}\n'
    )
    rows = ["block,kind,exposure_us,level,started_s,sensor_temperature_c,lines,radiance"]
    sums = ["block,samples,mean_dn,variance_dn2"]
    for number, step in enumerate(steps):
        exposure_us = float(step["texp_ns"]) * 1e-3
        for kind, what in (("flat", "bright"), ("dark", "dark")):
            name = f"{kind}{number:02d}"
            rows.append(f"{name},{kind},{exposure_us},{int(kind == 'flat')},,,2,")
            mean, variance = step[f"mean_{what}_DN"], step[f"var_{what}_DN2"]
            sums.append(f"{name},{2 * PIXELS},{mean},{variance}")
    (folder / "conditions.csv").write_text("\n".join(rows) + "\n")
    (folder / "statistics.csv").write_text("\n".join(sums) + "\n")
    return data_sheet(open_recording(folder))


def test_our_figures_are_those_that_emva_published(sheet: DataSheet) -> None:
    # The table gives means and variances to 1e-6, so that little more than 6 digits are left.
    for name, value in PUBLISHED.items():
        assert sheet[name].value == pytest.approx(value, rel=2e-6), name


def test_figures_in_photons_agree_to_the_table_s_whole_photons(sheet: DataSheet) -> None:
    # Photons are printed as whole numbers; ours go as the exposure. At the fit's lever, 16,000
    # photons, half a photon is 3e-5.
    for name, value in PUBLISHED_IN_PHOTONS.items():
        assert sheet[name].value == pytest.approx(value, rel=6e-5), name


def test_the_threshold_and_range_differ_by_release_4s_formula(sheet: DataSheet) -> None:
    # Release 3: σ_y.dark / K + 1/2; release 4: Eq. 27.
    gain, dark = sheet["system_gain_dn_per_e"].value, sheet["temporal_dark_noise_dn"].value
    release_3 = (dark / gain + 0.5) / sheet["quantum_efficiency"].value
    assert release_3 == pytest.approx(25.3600660517, rel=6e-5)
    assert sheet["sensitivity_threshold_photons"].value > release_3
    ratio = sheet["saturation_capacity_photons"].value / release_3
    assert ratio == pytest.approx(1220.69871336, rel=1e-4)


def test_a_straight_line_does_not_hold_and_that_is_said(sheet: DataSheet) -> None:
    said = " ".join(sheet.warnings)
    assert "photon transfer curve is no straight line" in said
    # With the quadratic response in the model K is 0.291 ± 0.002: outside the line's own error.
    gain = sheet["system_gain_dn_per_e"]
    assert (0.291 - gain.value) / gain.std > 5
    assert np.isfinite(sheet["linearity_error_percent"].value)
