"""What may be gone on with, and what may not."""

import pytest

from calib.errors import DarkflatError
from calib.recording.commit_log import commit_path
from service.sequencer.run import run_plan
from tests.service.sequencer.benches import short_plan, whole_blocks


def interrupted(bench, out, plan):
    """Run `plan` until its second block is begun."""
    frames = []

    def cancelled():
        return len(frames) >= 6

    run_plan(bench, plan, out, cancelled=cancelled, on_columns=frames.append)
    assert set(whole_blocks(out)) == {"000"}


def test_the_unfinished_block_is_done_again_after_settling_and_the_gap_is_noted(bench, out):
    interrupted(bench, out, short_plan())
    doing = []
    result = run_plan(
        bench, short_plan(), out, resume=True, on_progress=lambda p: doing.append(p.doing)
    )
    assert "waiting until level 1 is steady" in doing
    assert not any("recording 000" in text for text in doing)
    assert result.frames == 12
    assert any("resumed after a gap" in n and "block 001" in n for n in result.notes)
    assert set(whole_blocks(out)) == {"000", "001", "002", "003"}


def test_what_was_committed_before_the_end_stays_as_it_was(bench, out):
    interrupted(bench, out, short_plan())
    before = commit_path(out).read_bytes()
    run_plan(bench, short_plan(), out, resume=True)
    assert commit_path(out).read_bytes().startswith(before)


def test_times_go_on_across_the_gap(bench, out):
    interrupted(bench, out, short_plan())
    result = run_plan(bench, short_plan(), out, resume=True)
    assert result.state == "succeeded"


def test_a_finished_run_has_nothing_left_to_do(bench, out):
    run_plan(bench, short_plan(), out)
    again = run_plan(bench, short_plan(), out, resume=True)
    assert (again.state, again.frames, again.blocks_done) == ("succeeded", 0, 4)


def test_another_plan_is_refused_and_the_recording_left_alone(bench, out):
    interrupted(bench, out, short_plan())
    before = commit_path(out).read_bytes()
    with pytest.raises(DarkflatError, match="begun with another plan") as caught:
        run_plan(bench, short_plan(repeats=2), out, resume=True)
    assert caught.value.code == "plan-changed"
    assert commit_path(out).read_bytes() == before


def test_another_camera_is_refused(bench, out, monkeypatch):
    interrupted(bench, out, short_plan())
    other = bench.camera.identity.__class__("darkflat", "other", "B2")
    monkeypatch.setattr(type(bench.camera), "identity", other)
    with pytest.raises(DarkflatError, match="but camera B2 is connected") as caught:
        run_plan(bench, short_plan(), out, resume=True)
    assert caught.value.code == "wrong-camera"


def test_a_recording_that_is_there_is_not_begun_again(bench, out):
    run_plan(bench, short_plan(), out)
    before = out.read_bytes()
    with pytest.raises(DarkflatError, match="exists already"):
        run_plan(bench, short_plan(), out)
    assert out.read_bytes() == before


REFUSED = {
    "nothing to resume": ({}, True, "nothing-to-resume"),
    "more lamps than the bench has": (
        {"sweep": {"type": "exposure", "exposures_us": [1.0], "level": 4}},
        False,
        "level-out-of-range",
    ),
    "a plan for another camera": (
        {"camera": {"line_period_us": 1000.0, "serial": "B2"}},
        False,
        "wrong-camera",
    ),
}


@pytest.mark.parametrize(("changes", "resume", "code"), REFUSED.values(), ids=REFUSED)
def test_what_does_not_fit_is_refused_before_anything_is_written(bench, out, changes, resume, code):
    with pytest.raises(DarkflatError) as caught:
        run_plan(bench, short_plan(**changes), out, resume=resume)
    assert caught.value.code == code
    assert list(out.parent.iterdir()) == []


def test_a_folder_that_is_not_there_is_named(bench, tmp_path):
    with pytest.raises(DarkflatError, match="nowhere for the recording does not exist"):
        run_plan(bench, short_plan(), tmp_path / "nowhere" / "sweep.h5")
