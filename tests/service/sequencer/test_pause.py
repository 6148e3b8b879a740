"""A pause keeps nothing half done, holds the lamps as the plan says, and costs no block."""

import threading

import pytest

from drivers.errors import DeviceError
from service.sequencer.control import RunControl
from service.sequencer.run import run_plan
from tests.service.sequencer.benches import assert_dark, short_plan, whole_blocks

ALL = {"000": 32, "001": 32, "002": 32, "003": 32}


class Pauses:
    """Pauses a run at one of its frames, looks at the bench meanwhile, and lets it go on."""

    def __init__(self, control, at_frame, meanwhile):
        self.control, self.at_frame, self.meanwhile = control, at_frame, meanwhile
        self.frames, self.states = [], []

    def on_columns(self, columns):
        self.frames.append(columns.block)
        if len(self.frames) == self.at_frame:
            self.control.pause()

    def on_progress(self, progress):
        if self.states[-1:] != [progress.state]:
            self.states.append(progress.state)
        if progress.state == "paused" and self.control.is_pausing:
            self.meanwhile()


def paused(bench, out, plan, meanwhile, at_frame=6):
    control = RunControl()
    pauses = Pauses(control, at_frame, lambda: meanwhile(control))
    result = run_plan(
        bench, plan, out, control=control,
        on_columns=pauses.on_columns, on_progress=pauses.on_progress,
    )  # fmt: skip
    return result, pauses


@pytest.mark.parametrize("at_frame", [1, 4, 6, 8, 15])
def test_a_step_that_a_pause_broke_off_is_done_again_whole(bench, out, at_frame):
    result, pauses = paused(bench, out, short_plan(), RunControl.resume, at_frame)
    assert result.state == "succeeded"
    assert pauses.states == ["running", "paused", "running", "succeeded"]
    assert whole_blocks(out) == ALL


def test_the_lamps_are_off_while_paused_unless_the_plan_keeps_them_warm(bench, out, tmp_path):
    seen = []

    def look(control):
        seen.append([lamp.target for lamp in bench.world.state().lamps])
        control.resume()

    paused(bench, out, short_plan(), look)
    paused(bench, tmp_path / "warm.h5", short_plan(lamps={"while_paused": "warm"}), look)
    assert seen == [[0.0] * 3, [1.0, 0.0, 0.0]]
    assert_dark(bench.world)


def test_after_a_pause_the_light_settles_again(bench, out):
    doing = []
    control = RunControl()

    def listen(progress):
        doing.append(progress.doing)
        if progress.state == "paused":
            control.resume()

    frames = []

    def count(columns):
        frames.append(columns)
        if len(frames) == 6:
            control.pause()

    run_plan(bench, short_plan(), out, control=control, on_progress=listen, on_columns=count)
    after = doing[doing.index("going on after a pause") :]
    assert "waiting until level 1 is steady" in after


def test_a_pause_that_is_taken_back_at_once_loses_nothing(bench, out):
    control = RunControl()
    frames = []

    def flicker(columns):
        frames.append(columns)
        if len(frames) in {3, 6, 7, 12}:
            control.pause()
            control.resume()

    assert run_plan(bench, short_plan(), out, control=control, on_columns=flicker).state == (
        "succeeded"
    )
    assert whole_blocks(out) == ALL


def test_a_paused_run_can_be_aborted_and_resumed_later(bench, out):
    result, pauses = paused(bench, out, short_plan(), RunControl.abort)
    assert result.state == "cancelled"
    assert pauses.states == ["running", "paused", "aborting", "cancelled"]
    assert_dark(bench.world)
    run_plan(bench, short_plan(), out, resume=True)
    assert whole_blocks(out) == ALL


def test_a_pause_from_another_thread_stands_still_until_somebody_resumes(bench, out):
    control = RunControl()
    reached = threading.Event()
    frames, at_pause = [], []

    def let_go_on():
        reached.wait(30)
        at_pause.append(len(frames))
        threading.Event().wait(0.5)
        at_pause.append(len(frames))
        control.resume()

    def listen(progress):
        if progress.state == "paused":
            reached.set()

    def count(columns):
        frames.append(columns)
        if len(frames) == 6:
            control.pause()

    other = threading.Thread(target=let_go_on)
    other.start()
    run_plan(bench, short_plan(), out, control=control, on_progress=listen, on_columns=count)
    other.join()
    assert at_pause[0] == at_pause[1]
    assert whole_blocks(out) == ALL


@pytest.mark.parametrize("at_frame", [5, 6, 7, 8])
def test_lamps_that_safe_off_put_out_end_the_run_as_cancelled_not_as_failed(bench, out, at_frame):
    """They are seen to be out before the run has asked whether it is to end."""
    control = RunControl()
    frames = []

    def switch_off(columns):
        frames.append(columns)
        if len(frames) == at_frame:
            control.abort()
            bench.light.off()

    result = run_plan(bench, short_plan(), out, control=control, on_columns=switch_off)
    assert result.state == "cancelled"
    assert_dark(bench.world)
    assert list(whole_blocks(out)) == ["000"]


def test_a_lamp_that_goes_out_by_itself_is_a_fault(bench, out):
    frames = []

    def go_out(columns):
        frames.append(columns)
        if len(frames) == 8:
            bench.light.off()

    with pytest.raises(DeviceError) as out_of_itself:
        run_plan(bench, short_plan(), out, on_columns=go_out)
    assert out_of_itself.value.code == "lamp-out"
