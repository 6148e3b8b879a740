"""Recordings of one bench as one: a clock, what is common, and what is refused."""

from dataclasses import replace
from datetime import UTC, datetime, timedelta
from typing import Any

import numpy as np
import pytest
from numpy.random import default_rng

from calib.diagnosis.baseline.nuisance import regressors
from calib.diagnosis.recorded.joint import HOURS_APART_S, joint
from calib.errors import InputError
from calib.forward.effects.offset import Offset
from calib.recording.header import Block, CameraHeader, RecordingHeader
from tests.calib.diagnosis.recordings import plain_model, recorded

BEGAN = datetime(2026, 11, 22, 9, 30, tzinfo=UTC)


def header(after_s: float | None = 0.0, **changes: Any) -> RecordingHeader:
    """Return two blocks of a second each, begun so long after 9:30; or nobody knows when."""
    began = None if after_s is None else BEGAN + timedelta(seconds=after_s)
    known = {"columns": 8, "bit_depth": 12, "line_period_us": 1e4, "serial": "A"}
    blocks = tuple(
        Block(block=f"{k:03d}", kind="flat", exposure_us=9.0, level=1.0, started_s=2.0 * k,
              lines=100, scene="bar")
        for k in range(2)
    )  # fmt: skip
    camera = CameraHeader.model_validate({**known, "started_at": began, **changes})
    return RecordingHeader(camera=camera, blocks=blocks)


def test_one_recording_is_itself() -> None:
    alone = joint([header()])
    assert alone.header == header()
    assert alone.note == ""


def test_blocks_stand_on_one_clock_in_the_order_of_time() -> None:
    whole = joint([header(50.0), header()])
    assert whole.order == (1, 0)
    assert [b.block for b in whole.header.blocks] == ["2:000", "2:001", "1:000", "1:001"]
    assert [b.started_s for b in whole.header.blocks] == [0.0, 2.0, 50.0, 52.0]
    assert whole.header.blocks[0].scene == "2:bar"
    assert whole.sessions == ()
    assert "common" in whole.note


def test_recordings_that_do_not_tell_when_follow_one_another() -> None:
    whole = joint([header(None), header(None)])
    assert [b.started_s for b in whole.header.blocks] == [0.0, 2.0, 3.0, 5.0]


def test_hours_apart_are_sessions_of_their_own() -> None:
    whole = joint([header(), header(HOURS_APART_S + 5.0)])
    assert whole.sessions == (0, 0, 1, 1)
    assert "its own" in whole.note


@pytest.mark.parametrize(
    ("other", "code"),
    [
        (header(50.0, serial="B"), "recordings-differ"),
        (header(50.0, columns=9), "recordings-differ"),
        (header(50.0, line_period_us=9e3), "recordings-differ"),
        (header(1.5), "recordings-overlap"),
        (header(), "recordings-overlap"),
    ],
)
def test_what_is_not_of_one_bench_is_refused(other: RecordingHeader, code: str) -> None:
    with pytest.raises(InputError) as refused:
        joint([header(), other])
    assert refused.value.code == code


def test_sessions_absorb_what_moved_between_them_and_nothing_else() -> None:
    rng = default_rng()
    rows = [(200.0, 0.0), (200.0, 1.0), (500.0, 1.0), (900.0, 1.0)]
    blocks = [
        Block(block=str(k), kind="flat" if level else "dark", exposure_us=t, level=level, lines=100)
        for k, (t, level) in enumerate(rows * 2)
    ]
    one = recorded(plain_model(64), blocks[:4], rng)
    other = recorded(plain_model(64), blocks[4:], rng, (Offset(66.0, 1.0),))
    both = recorded(plain_model(64), blocks, rng)
    mean = np.concatenate([[s.mean_dn.ravel() for s in e.sums] for e in (one, other)])
    moved = mean - both.baseline.mean_dn.reshape(mean.shape)
    apart = replace(both.table, sessions=(0,) * 4 + (1,) * 4)
    tables = (both.table, apart)
    assert [len(regressors(table, moved.shape)) for table in tables] == [2, 4]
    spaces = [replace(both, table=table).space for table in tables]
    squared = [float((space.project(moved) ** 2).sum()) for space in spaces]
    freedom = spaces[1].degrees_of_freedom
    # 2 DN among 8 blocks of 64 pixels are not absorbed by common offsets; by own ones wholly.
    assert squared[0] > 10.0 * freedom
    assert abs(squared[1] - freedom) < 5.0 * np.sqrt(2.0 * freedom)
