"""The data sheet's page, JSON and XML show what was found, whole, and need nothing else."""

import json
import re
from xml.etree import ElementTree as ET

import numpy as np
import pytest

from calib.transfer.emva1288.catalogue import CATALOGUE
from calib.transfer.emva1288.data_sheet import data_sheet
from calib.transfer.emva1288.machine_readable import to_json, to_xml
from calib.transfer.emva1288.report.page import CAPTIONS, figures, write_page
from calib.transfer.emva1288.report.words import rounded
from calib.transfer.emva1288.sheet import DataSheet
from tests.calib.transfer.emva1288.drawn_camera import DrawnCamera
from tests.calib.transfer.emva1288.plans import bench


@pytest.fixture(scope="module")
def area() -> DataSheet:
    rng = np.random.default_rng(201)
    return data_sheet(bench(rng).record(rng))


@pytest.fixture(scope="module")
def line() -> DataSheet:
    """A line sensor that states no photons."""
    rng = np.random.default_rng(202)
    drawn = bench(rng, DrawnCamera(rows=None, columns=256))
    return data_sheet(drawn.record(rng, frames=40, stack=40, photons_per_pixel_per_us=None))


@pytest.fixture(scope="module")
def page(area: DataSheet, tmp_path_factory: pytest.TempPathFactory) -> str:
    path = tmp_path_factory.mktemp("page") / "sheet.html"
    write_page(path, area)
    assert list(path.parent.iterdir()) == [path]
    return path.read_text("utf-8")


def test_every_figure_that_there_is_stands_on_the_page(page: str) -> None:
    drawn = set(CAPTIONS) - {"dark-current-doubling"}
    assert page.count("<svg") == len(drawn)
    assert all(CAPTIONS[name] in page.replace("&#39;", "'") for name in drawn)


def test_nothing_is_fetched(page: str) -> None:
    assert re.findall(r'(?:src|href)="(?!#|data:)([^"]*)"', page) == []
    assert "<script" not in page
    assert "@import" not in page


def test_every_number_reason_and_warning_is_on_the_page(page: str, area: DataSheet) -> None:
    plain = page.replace("&#39;", "'").replace("&#34;", '"')
    for figure in CATALOGUE:
        known = area[figure.name]
        assert (rounded(known) if known.is_known else known.reason) in plain, figure.name
    assert all(warning in plain for warning in area.warnings)


def test_the_curves_are_the_measured_points(area: DataSheet) -> None:
    drawn = {f.name: f.figure for f in figures(area)}
    used, rest = drawn["photon-transfer"].axes[0].lines[:2]
    curve = area.transfer
    np.testing.assert_array_equal(used.get_ydata(), curve.variance_dn2[curve.in_transfer])
    np.testing.assert_array_equal(rest.get_xdata(), curve.signal_dn[~curve.in_transfer])
    model = drawn["signal-to-noise"].axes[0].lines[1]
    at = np.interp(area["sensitivity_threshold_photons"].value, model.get_xdata(),
                   model.get_ydata())  # fmt: skip
    assert at == pytest.approx(1.0, rel=1e-3)  # the threshold is where SNR is 1


def test_a_line_sensor_s_page_leaves_out_what_it_has_not(line: DataSheet) -> None:
    drawn = {f.name: f.figure for f in figures(line)}
    assert len(drawn["prnu-spectrograms"].axes) == 1
    assert drawn["signal-to-noise"].axes[0].get_xlabel() == "signal, e⁻"


def test_json_holds_every_point(area: DataSheet, line: DataSheet) -> None:
    told = json.loads(to_json(area))
    assert told["system_gain_dn_per_e"]["std"] == area["system_gain_dn_per_e"].std
    assert told["curves"]["transfer"]["signal_dn"] == area.transfer.signal_dn.tolist()
    assert told["curves"]["transfer"]["deviation_percent"][0] is None  # below 5 %
    assert sum(told["curves"]["spatial"]["flat"]["histogram"]["count"]) == (48 - 18) ** 2
    assert json.loads(to_json(line))["curves"]["spatial"]["dark"]["vertical"] is None


def test_xml_has_emvas_names_and_units(area: DataSheet) -> None:
    root = ET.fromstring(to_xml(area))  # noqa: S314 - our own
    assert root.tag == "results"
    gain = root.find("sensitivity/K")
    assert gain is not None
    assert float(gain.findtext("Value", "")) == area["system_gain_dn_per_e"].value
    efficiency = root.find("sensitivity/QE")
    assert efficiency is not None
    assert float(efficiency.findtext("Value", "")) == 100 * area["quantum_efficiency"].value
    assert efficiency.findtext("Unit") == "%"
    for name in ("spatial/DSNU1288", "spatial/PRNU1288_col", "linearity/LE_max",
                 "dark_current/u_I_mean", "sensitivity/u_p_sat"):  # fmt: skip
        assert np.isfinite(float(root.findtext(f"{name}/Value", "nan"))), name
    counts = root.findtext("defect_pixel/histogram_DSNU/Data/values", "").split()
    assert sum(map(int, counts)) == 48 * 48
    beyond = root.findtext("defect_pixel/histogram_PRNU_accumulated/Data/values", "").split()
    assert int(beyond[0]) == (48 - 18) ** 2


def test_xml_says_why_a_figure_is_missing(line: DataSheet) -> None:
    root = ET.fromstring(to_xml(line))  # noqa: S314 - our own
    assert root.findtext("sensitivity/QE/Value") == "nan"
    assert "photons_per_pixel_per_us" in root.findtext("sensitivity/QE/Comment", "")
