"""Figures: what Plotly is given is what was measured."""

import base64
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from service.owner.messages import Seen
from service.page.figures.live import profile, waterfall
from service.page.figures.plot import banded, packed
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
