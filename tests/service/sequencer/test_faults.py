"""Whatever goes wrong: lamps off, one clear sentence, and a recording that can be gone on with."""

import contextlib
import os
import resource
import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import pytest

from calib.errors import DarkflatError
from calib.recording.file_recording import FileRecording
from service.bench import Bench, open_bench
from service.sequencer.run import run_plan
from tests.service.sequencer.benches import assert_dark, in_process, short_plan, whole_blocks


def _camera_gone(bench: Bench) -> None:
    bench.camera.faults.vanished = True


def _frames_lost(bench: Bench) -> None:
    bench.camera.faults.to_lose = 1000


def _lamp_out(bench: Bench) -> None:
    bench.light.brown_out(1)


def _monitor_gone(bench: Bench) -> None:
    bench.monitor.line.fault = "lost"


def _monitor_overflow(bench: Bench) -> None:
    bench.monitor.range_a = 1e-9


def _too_hot(bench: Bench) -> None:
    bench.world.warm(61.0)


def _shutter_stuck(bench: Bench) -> None:
    bench.shutter.stuck = True


LIMITS = {"interlocks": {"camera_temperature_c": [10.0, 50.0]}}

FAULTS: dict[str, tuple[Callable[[Bench], None], str, str]] = {
    "camera unplugged": (_camera_gone, "control-lost", "camera"),
    "frames lost": (_frames_lost, "frames-lost", "were lost"),
    "lamp out": (_lamp_out, "lamp-out", "lamp 1 is off"),
    "monitor unplugged": (_monitor_gone, "device-lost", "monitor"),
    "monitor out of range": (_monitor_overflow, "monitor-overflow", "range"),
    "camera too hot": (_too_hot, "interlock", "61.0 °C"),
    "shutter stuck": (_shutter_stuck, "shutter-stuck", "shutter"),
}


def at_frame(n: int, act: Callable[[], None]):
    """Return a listener that acts once, when `n` frames are committed."""
    acted = []

    def listen(progress):
        if progress.frames >= n and not acted:
            acted.append(True)
            act()

    return listen


@pytest.mark.parametrize(("inject", "code", "said"), FAULTS.values(), ids=FAULTS)
def test_a_fault_in_a_block_ends_dark_in_one_sentence_and_can_be_salvaged(
    bench, out, inject, code, said
):
    states = []
    trigger = at_frame(6, lambda: inject(bench))

    def listen(progress):
        states.append(progress.state)
        trigger(progress)

    with pytest.raises(DarkflatError) as caught:
        run_plan(bench, short_plan(**LIMITS), out, on_progress=listen)
    assert caught.value.code == code
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)
    assert_dark(bench.world)
    assert states[-2:] == ["aborting", "failed"]
    kept = whole_blocks(out)
    assert set(kept) < {"000", "001", "002", "003"}
    assert set(kept.values()) == {32}


@pytest.mark.parametrize("inject", [_lamp_out, _too_hot, _frames_lost])
def test_a_run_that_failed_goes_on_once_the_fault_is_mended(bench, out, inject):
    with pytest.raises(DarkflatError):
        run_plan(bench, short_plan(**LIMITS), out, on_progress=at_frame(6, lambda: inject(bench)))
    bench.world.warm(25.0)
    bench.camera.faults.to_lose = 0
    result = run_plan(bench, short_plan(**LIMITS), out, resume=True)
    assert result.state == "succeeded"
    assert whole_blocks(out) == dict.fromkeys(("000", "001", "002", "003"), 32)
    assert_dark(bench.world)


TWO_LAMPS = {"sweep": {"type": "exposure", "exposures_us": [50.0, 100.0], "level": 2}}


def _second_lamp_out(bench: Bench) -> None:
    bench.light.brown_out(2)


def _first_lamp_dim(bench: Bench) -> None:
    bench.light._drive(1, 3.0)


def _third_lamp_lit(bench: Bench) -> None:
    bench.light._drive(3, 4.0)


WRONG_LAMPS = {
    "one of two goes out": (_second_lamp_out, "but level 1 reads back (lamp 2 is off)"),
    "its mains sag": (_first_lamp_dim, "but level 1 reads back (lamp 1 is at 3 A, not 4 A)"),
    "one burns too many": (_third_lamp_lit, "but level 3 reads back (lamp 3 is on)"),
}


@pytest.mark.parametrize(("inject", "said"), WRONG_LAMPS.values(), ids=WRONG_LAMPS)
def test_a_lamp_that_changes_in_the_middle_of_a_block_is_named_and_the_block_is_not_whole(
    bench, out, inject, said
):
    with pytest.raises(DarkflatError) as caught:
        run_plan(
            bench, short_plan(**TWO_LAMPS), out, on_progress=at_frame(6, lambda: inject(bench))
        )
    assert caught.value.code == "lamp-out"
    assert "level 2 should burn in block 001" in str(caught.value)
    assert said in str(caught.value)
    assert set(whole_blocks(out)) == {"000"}
    begun = [frame.block for frame in FileRecording(out).commits.every_frame]
    assert begun.count("001") == 4  # all of its frames came, and none of them counts
    assert_dark(bench.world)


def test_light_that_drifts_beyond_the_interlock_within_a_block_spoils_the_block(bench, out):
    """The supplies read back as they should: only the monitor sees it."""
    limits = {"interlocks": {"monitor_a": [1.5e-7, 2.5e-7]}}

    def half_as_bright():
        bench.world.drive(0, 0.5)

    with pytest.raises(DarkflatError, match="after block 001: the monitor reads") as caught:
        run_plan(bench, short_plan(**limits), out, on_progress=at_frame(6, half_as_bright))
    assert caught.value.code == "interlock"
    assert set(whole_blocks(out)) == {"000"}
    assert_dark(bench.world)


def test_a_light_that_is_lost_is_said_to_be_still_on(bench, out):
    def unplug():
        bench.light.line.fault = "lost"

    with pytest.raises(DarkflatError) as caught:
        run_plan(bench, short_plan(), out, on_progress=at_frame(6, unplug))
    assert caught.value.code == "lamps-not-off"
    assert "switch them off by hand" in str(caught.value)
    assert set(whole_blocks(out).values()) == {32}
    bench.light.line.fault = "none"


def test_a_lamp_that_does_not_go_off_is_an_error_even_after_a_good_run(bench, out):
    bench.light.stuck.add(1)
    with pytest.raises(DarkflatError, match="lamp 1") as caught:
        run_plan(bench, short_plan(), out)
    assert caught.value.code == "lamps-not-off"
    assert len(whole_blocks(out)) == 4
    bench.light.stuck.clear()


def test_a_light_that_never_settles_is_named_with_what_the_monitor_did(bench, out):
    settle = {"tolerance_percent": 1e-9, "stable_for_s": 0.02, "interval_s": 0.01, "timeout_s": 0.1}
    with pytest.raises(DarkflatError, match="level 1 was not steady") as caught:
        run_plan(bench, short_plan(settle=settle), out)
    assert caught.value.code == "light-not-settled"
    assert "the monitor" in str(caught.value)
    assert_dark(bench.world)


def test_the_monitor_interlock_holds_only_while_lamps_are_seen(bench, out):
    dim = {"interlocks": {"monitor_a": [1e-12, 1e-9]}}
    with pytest.raises(DarkflatError, match="before block 001: the monitor reads") as caught:
        run_plan(bench, short_plan(**dim), out)
    assert caught.value.code == "interlock"
    assert set(whole_blocks(out)) == {"000"}
    assert_dark(bench.world)


def test_a_full_disk_is_found_before_anything_is_lit(bench, out, monkeypatch):
    class Full:
        free = 1000

    monkeypatch.setattr("service.sequencer.disk.shutil.disk_usage", lambda _path: Full)
    with pytest.raises(DarkflatError, match=r"needs \d+\.\d MB") as caught:
        run_plan(bench, short_plan(), out)
    assert caught.value.code == "disk-full"
    assert list(out.parent.iterdir()) == []


@contextmanager
def file_size_limit(n_bytes: int) -> Iterator[None]:
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (n_bytes, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


def test_a_disk_that_fills_up_meanwhile_ends_the_run_dark_and_it_goes_on_later(bench, out):
    plan = short_plan(lines=8 * 400, frame_lines=400, camera={"line_period_us": 1000.0})
    with file_size_limit(2_000_000), pytest.raises(DarkflatError) as caught:
        run_plan(bench, plan, out)
    assert caught.value.code == "disk-full"
    assert_dark(bench.world)
    assert run_plan(bench, plan, out, resume=True).state == "succeeded"
    assert set(whole_blocks(out).values()) == {3200}


@pytest.mark.parametrize("frames", [0, 1, 5, 14])
def test_an_abort_ends_dark_and_the_run_can_be_resumed(bench, out, frames):
    stop, states = [], []
    trigger = at_frame(frames, lambda: stop.append(True))

    def listen(progress):
        states.append(progress.state)
        trigger(progress)

    result = run_plan(bench, short_plan(), out, cancelled=lambda: bool(stop), on_progress=listen)
    assert result.state == "cancelled"
    assert states[-2:] == ["aborting", "cancelled"]
    assert_dark(bench.world)
    resumed = run_plan(bench, short_plan(), out, resume=True)
    assert (resumed.state, resumed.blocks_done) == ("succeeded", 4)
    assert set(whole_blocks(out).values()) == {32}


def test_ctrl_c_ends_dark_and_is_passed_on(bench, out):
    states = []

    def interrupt():
        raise KeyboardInterrupt

    trigger = at_frame(6, interrupt)

    def listen(progress):
        states.append(progress.state)
        trigger(progress)

    with pytest.raises(KeyboardInterrupt):
        run_plan(bench, short_plan(), out, on_progress=listen)
    assert states[-1] == "interrupted"
    assert_dark(bench.world)


def test_a_signal_whose_exception_gets_lost_in_a_library_ends_the_run_all_the_same(out):
    def lose_it():
        with contextlib.suppress(KeyboardInterrupt):
            signal.raise_signal(signal.SIGINT)

    def work():
        with open_bench(in_process(f"lost-{os.getpid()}")) as bench:
            result = run_plan(bench, short_plan(), out, on_progress=at_frame(6, lose_it))
            assert result.state == "cancelled"
            assert_dark(bench.world)

    with pytest.raises(KeyboardInterrupt):
        work()
