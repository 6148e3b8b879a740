"""Every row of the benchmarks runs at toy size; nothing here judges how long it takes."""

import json
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from benchmarks.catalogue import ROWS
from benchmarks.race import race
from benchmarks.size import Size
from benchmarks.table import HEADINGS, markdown
from benchmarks.timing import OwnTime, take_turns

ROOT = Path(__file__).parents[1]
TOY = Size(
    n_lines=64,
    n_columns=128,
    n_frames=2,
    fit_pixels=1000,
    stack_rows=30,
    stack_columns=40,
    stack_frames=16,
    rounds=1,
    recording_s=0.2,
    recording_mb_s=1.0,
)


@pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=pytest.mark.aravis if name == "record" else ()) for name in ROWS],
)
def test_a_row_gives_rates_and_a_verdict(name: str, tmp_path: Path) -> None:
    if name == "record":
        pytest.importorskip("gi")
    row = ROWS[name](replace(TOY, folder=tmp_path))
    assert row.ours > 0
    assert row.limit.rate > 0
    assert isinstance(row.reached, bool)
    assert list(tmp_path.iterdir()) == []
    assert markdown([row]).splitlines()[-1].count(" | ") == len(HEADINGS) - 1


def test_a_peer_takes_its_turns_in_its_own_process(tmp_path: Path) -> None:
    # Welford's sums need NumPy alone, so that our own Python can stand in for the peers'.
    row = ROWS["sums"](replace(TOY, peers=Path(sys.executable)))
    assert row.peers["Welford"].rate > 0


def test_a_peer_that_dies_is_said_so() -> None:
    with pytest.raises(RuntimeError, match="a peer died"):
        ROWS["apply"](replace(TOY, peers=Path("/bin/true")))


def test_contestants_take_turns_and_the_warm_up_does_not_count() -> None:
    order: list[str] = []
    timing = take_turns(
        {name: lambda name=name: order.append(name) for name in "ab"}, rounds=2, warm_up=1
    )
    assert order == list("ababab")
    assert len(timing.rounds["a"]) == len(timing.rounds["b"]) == 2


def test_ratios_are_those_of_the_same_turn() -> None:
    slow, fast = (iter([OwnTime(each) for each in times]) for times in ((9, 2, 20), (9, 1, 10)))
    timing = take_turns(
        {"ours": lambda: next(fast), "other": lambda: next(slow)}, rounds=2, warm_up=1
    )
    assert timing.ratio("other", to="ours") == 2.0
    assert timing.seconds("ours") == 5.5


def test_a_rate_is_work_by_time_and_ours_is_told_in_multiples_of_it() -> None:
    figures = race(10.0, {"ours": lambda: OwnTime(2.0), "other": lambda: OwnTime(8.0)}, rounds=3)
    assert figures["ours"].rate == 5.0
    assert figures["other"].rate == 1.25
    assert figures["other"].ours_is == 4.0


def test_a_row_that_there_is_not_is_refused_and_the_others_named() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "benchmarks", "nonsense"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 2
    assert "calibrate-8" in done.stderr


def test_json_goes_alone_to_standard_output(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "benchmarks", "--quick", "--json", "-", "apply"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    assert json.loads(done.stdout)["apply"]["unit"] == "MB/s moved"
