"""Figures: what Plotly is given is what was measured."""

import base64
from typing import Any

import numpy as np
import pytest
from numpy.random import default_rng
from numpy.typing import NDArray

from service.owner.messages import Seen
from service.page.figures.live import profile, waterfall
from service.page.figures.photon_transfer import (
    Points,
    linearity,
    linearity_residuals,
    mean_variance,
    mean_variance_residuals,
)
from service.page.figures.plot import banded, packed
from service.page.figures.transfer import Cut, cuts, modulus, phase
from service.page.live import MOST_LINES, Live
from service.runs.news import News


def unpacked(sent: dict[str, str]) -> NDArray[np.float32]:
    flat = np.frombuffer(base64.b64decode(sent["bdata"]), "<f4")
    return flat.reshape([int(n) for n in sent["shape"].split(",")]) if "shape" in sent else flat


@pytest.mark.parametrize("shape", [(5,), (3, 4)])
def test_what_is_packed_comes_out_again(shape: tuple[int, ...]) -> None:
    values = np.random.default_rng().normal(size=shape)
    np.testing.assert_array_equal(unpacked(packed(values)), values.astype(np.float32))


def test_a_band_is_two_standard_uncertainties_wide_on_each_side() -> None:
    low, high, line = banded([0.0, 1.0], [10.0, 20.0], [1.0, 3.0], name="QE")
    assert unpacked(low["y"]).tolist() == [8.0, 14.0]
    assert unpacked(high["y"]).tolist() == [12.0, 26.0]
    assert unpacked(line["y"]).tolist() == [10.0, 20.0]


def test_columns_are_those_of_the_camera_and_the_newest_frame_is_on_top() -> None:
    seen = [Seen("r", "000", np.arange(400.0) + n, 8) for n in range(3)]
    assert unpacked(profile(seen)["data"][0]["x"])[:3].tolist() == [0.0, 8.0, 16.0]
    (picture,) = waterfall(seen)["data"]
    lines = unpacked(picture["z"])
    assert lines[:, 0].tolist() == [2.0, 1.0, 0.0]
    assert lines[0].tolist() == [2.0 + n for n in range(0, 400, 2)]
    assert unpacked(picture["x"])[1] == 16.0


def test_the_waterfall_holds_one_run_and_the_newest_lines_of_it() -> None:
    news = News()
    live = Live(news)
    assert live.seen() == ()

    def show(run: str, *values: float) -> None:
        for value in values:
            news.show(Seen(run, "000", np.full(4, value)))
            news.tell()  # of something else: no new line

    show("a", *range(MOST_LINES + 5))
    levels: Any = [each.mean_dn[0] for each in live.seen()]
    assert levels == list(range(5, MOST_LINES + 5))
    show("b", 7.0)
    assert [each.run_id for each in live.seen()] == ["b"]


SHEET: dict[str, Any] = {
    "system_gain_dn_per_e": {"value": 0.5, "std": 0.001, "unit": "DN/e-"},
    "curves": {
        "transfer": {
            "light": [100.0, 200.0, 400.0],
            "photons": [300.0, 600.0, 1200.0],
            "signal_dn": [1010.0, 2000.0, 3900.0],
            "signal_std": [10.0, 10.0, 10.0],
            "variance_dn2": [510.1, 1000.0, 1930.5],
            "variance_std": [5.05, 10.0, 19.5],
            "in_transfer": [True, True, False],
            "share_at_full_scale": [0.0, 0.0, 0.001],
            "line": [10.0, 10.0],
        }
    },
}
"""A gain of 0.5 DN/e-, and a line of 10 DN + 10 DN/µs."""


def test_a_data_sheet_s_lines_leave_what_is_off_them_in_percent() -> None:
    points = Points.of(SHEET)
    inside, beyond = mean_variance_residuals(points)["data"]
    np.testing.assert_allclose(unpacked(inside["y"]), [1.01, 0.0], atol=0.001)
    np.testing.assert_allclose(unpacked(inside["error_y"]["array"]), [2.0, 2.0], rtol=1e-6)
    np.testing.assert_allclose(unpacked(beyond["y"]), [-1.0], rtol=1e-5)
    (flats,) = linearity_residuals(points)["data"]
    np.testing.assert_allclose(unpacked(flats["x"]), [300.0, 600.0, 1200.0])
    lines = np.array([1010.0, 2010.0, 4010.0])
    left = 100 * (np.array([1010.0, 2000.0, 3900.0]) / lines - 1.0)
    np.testing.assert_allclose(unpacked(flats["y"]), left, atol=1e-5)
    np.testing.assert_allclose(unpacked(flats["error_y"]["array"]), 2000.0 / lines, rtol=1e-6)
    line = linearity(points)["data"][0]
    np.testing.assert_allclose(unpacked(line["y"]), [10.0, 4010.0])
    assert mean_variance(points)["layout"]["xaxis"]["title"]["text"].endswith("/ DN")


def test_a_clipped_flat_is_grey_and_leaves_no_residual() -> None:
    curve = {**SHEET["curves"]["transfer"], "share_at_full_scale": [0.0, 0.0, 0.3]}
    points = Points.of({**SHEET, "curves": {"transfer": curve}})
    for drawn in (mean_variance_residuals, linearity_residuals):
        _, clipped = drawn(points)["data"]
        assert np.isnan(unpacked(clipped["y"])).all()
    assert unpacked(linearity(points)["data"][2]["x"]).tolist() == [1200.0]


def test_without_photons_the_light_is_exposure_times_level() -> None:
    curve = {**SHEET["curves"]["transfer"], "photons": None, "line": [None, None]}
    gain = {"value": None, "std": None, "unit": "DN/e-", "reason": "too few flats"}
    points = Points.of({"system_gain_dn_per_e": gain, "curves": {"transfer": curve}})
    assert points.light.tolist() == [100.0, 200.0, 400.0]
    assert points.light_name == "exposure × level / µs"
    assert [len(drawn(points)["data"]) for drawn in (mean_variance, linearity)] == [2, 1]  # no line


def test_cuts_of_a_map_start_at_0_and_go_along_their_axis() -> None:
    frequency = np.array([-10.0, 0.0, 10.0])
    at_x, at_y = np.meshgrid(frequency, frequency)
    transfer = (1.0 - 0.01 * np.abs(at_x) - 0.03 * np.abs(at_y)).astype(complex)
    arrays = {
        "frequency_per_mm": frequency,
        "transfer": transfer,
        "transfer_real_std": 0.001 * at_x**2,
        "transfer_imaginary_std": 0.001 * at_y**2,
    }
    along_x, along_y = cuts(arrays, {})
    assert (along_x.axis, along_y.axis) == ("x", "y")
    np.testing.assert_allclose(along_x.transfer, [1.0, 0.9])
    np.testing.assert_allclose(along_y.transfer, [1.0, 0.7])
    np.testing.assert_allclose(along_x.real_std, [0.0, 0.1])
    np.testing.assert_allclose(along_y.imaginary_std, [0.0, 0.1])


def test_modulus_and_phase_scatter_by_their_standard_uncertainties() -> None:
    n, true, real_std, imaginary_std = 20_000, 0.3 + 0.2j, 0.001, 0.002
    one = np.ones(1)
    cut = Cut("x", one, true * one, real_std * one, imaginary_std * one)
    rng = default_rng()
    drawn = true + rng.normal(0, real_std, n) + 1j * rng.normal(0, imaginary_std, n)
    # A standard deviation of n draws scatters by 1/√(2n) of itself; the bend of |T| is 1e-5 of it.
    bound = 4.5 / np.sqrt(2 * n)
    assert abs(np.abs(drawn).std() / cut.modulus_std[0] - 1.0) < bound
    assert abs(np.degrees(np.angle(drawn)).std() / cut.phase_std_deg[0] - 1.0) < bound


def test_a_phase_that_is_not_determined_is_a_gap() -> None:
    one = np.ones(2)
    cut = Cut("x", np.array([0.0, 40.0]), np.array([1.0, 0.01j]), 0.005 * one, 0.005 * one)
    (*_, line) = phase([cut])["data"]
    assert unpacked(line["y"]).tolist()[0] == 0.0
    assert np.isnan(unpacked(line["y"])[1])
    assert unpacked(modulus([cut], 25.0)["data"][2]["y"]).tolist() == pytest.approx([1.0, 0.01])
    assert modulus([cut], 25.0)["data"][-1]["x"] == [20.0, 20.0]
