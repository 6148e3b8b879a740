"""The time left that is shown is the one that the work itself knows."""

from collections.abc import Callable
from pathlib import Path

import pytest
from rich.progress import Progress as Bar

from service.cli import progress as shown
from service.cli.progress import Left, progress
from service.cli.sweep_progress import sweep_progress
from service.cli.time_left_column import TimeLeftColumn
from service.sequencer.events import Progress
from tests.service.cli.answers import Ran
from tests.service.cli.benches import bench_file, plan_for_bench


class Clock:
    now_s = 1000.0

    def monotonic(self) -> float:
        return self.now_s


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    clock = Clock()
    monkeypatch.setattr("time.monotonic", clock.monotonic)
    return clock


def at(done: int, seconds_left: float | None) -> Progress:
    return Progress("running", done, 10, 0, 0, seconds_left, "block 4")


@pytest.mark.parametrize(
    ("seconds_left", "said"),
    [(28.0, "Sweep: 20%; 28 s left; block 4"), (None, "Sweep: 20%; block 4")],
)
def test_a_line_of_a_sweep_has_the_estimate_of_the_sequencer(
    clock: Clock, capsys: pytest.CaptureFixture[str], seconds_left: float | None, said: str
) -> None:
    with progress("Sweep") as report:
        clock.now_s += 24  # by the share, 96 s would be left
        sweep_progress(report)(at(2, seconds_left))
    assert capsys.readouterr().err == said + "\n"


def test_a_line_of_other_work_goes_by_the_share(
    clock: Clock, capsys: pytest.CaptureFixture[str]
) -> None:
    with progress("Exporting") as report:
        clock.now_s += 24
        report(0.2, "")
    assert "96 s left" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("until_s", "said"), [(1000.0 + 3725, "1:02:05"), (990.0, "0:00:00"), (None, "-:--:--")]
)
def test_the_bar_counts_down(clock: Clock, until_s: float | None, said: str) -> None:
    bar = Bar(TimeLeftColumn())
    bar.add_task("Sweep", total=1.0, until_s=until_s)
    assert TimeLeftColumn()(bar.tasks[0]).plain == said


def test_a_part_of_longer_work_keeps_its_share(clock: Clock) -> None:
    told: list[tuple[float, str, Left]] = []
    tell = sweep_progress(lambda *each: told.append(each), first=0.05, last=0.8)
    tell(at(0, None))
    tell(at(10, 0.0))
    assert [share for share, _, _ in told] == pytest.approx([0.05, 0.8])
    assert [left for _, _, left in told] == [None, 0.0]


def test_sweep_shows_what_the_sequencer_says(
    run: Callable[..., Ran], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(shown, "_LINE_EVERY_S", 0.0)
    monkeypatch.setattr("service.sequencer.pace.Pace.seconds_left", lambda _: 4321.0)
    plan, bench = plan_for_bench(tmp_path), bench_file(tmp_path)
    ran = run("sweep", plan, "--out", tmp_path / "rec.h5", "--bench", bench)
    assert ran.status == 0, ran.stderr
    lines = [line for line in ran.stderr.splitlines() if line.startswith("Sweep: ")]
    assert lines
    assert all("4321 s left" in line for line in lines)
