"""What goes wrong with a GigE Vision camera in the middle of a run: see docs/faults.md."""

import importlib.util
import os
import re
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from calib.errors import DarkflatError
from calib.recording.file_recording import FileRecording
from service.bench import Bench, BenchSettings, open_bench
from service.sequencer.events import OnProgress, Progress
from service.sequencer.run import run_plan
from tests.contracts.simulated_camera import ADDRESS_WAIT_S
from tests.service.sequencer.benches import assert_dark, in_process, short_plan, whole_blocks
from tests.service.sequencer.test_faults import at_frame

pytestmark = [
    pytest.mark.aravis,
    pytest.mark.skipif(importlib.util.find_spec("gi") is None, reason="PyGObject is not there"),
]

PLAN = short_plan(camera={"line_period_us": 400.0, "columns": 512}, lines=256, frame_lines=32)
EVERY_BLOCK = dict.fromkeys(("000", "001", "002", "003"), 256)


@pytest.fixture(scope="module")
def gige() -> Iterator[Bench]:
    """A bench whose lamps are quick; only the camera is on a line."""
    quick = in_process(f"gige-{os.getpid()}").model_dump(exclude_none=True)
    quick["camera"] = {"driver": "aravis"}
    quick["simulation"]["camera_wait_s"] = ADDRESS_WAIT_S
    with open_bench(BenchSettings.parse(quick)) as bench:
        yield bench


FRAMES_BEFORE = 4
"""Of the eight of block 001: the camera itself counts them and then fails. Told to fail at once, a
busy machine's camera may have sent all eight before it hears of that."""

Mending = ExitStack
"""What takes the fault back."""


def _lose_packets(bench: Bench, mending: Mending) -> None:
    bench.simulated.camera.lose_packets(0.7, after_frames=FRAMES_BEFORE)
    mending.callback(bench.simulated.camera.lose_packets, 0.0)


def _stall(bench: Bench, mending: Mending) -> None:
    bench.simulated.camera.stall(after_frames=FRAMES_BEFORE)
    mending.callback(bench.simulated.camera.resume)


def _die(bench: Bench, mending: Mending) -> None:
    bench.simulated.camera.die(after_frames=FRAMES_BEFORE)
    mending.callback(bench.simulated.camera.start)
    mending.callback(bench.simulated.camera.kill)


def _take_control(bench: Bench, mending: Mending) -> None:
    from drivers.aravis.camera import AravisCamera

    bench.camera._held().camera.get_device().leave_control()
    mending.callback(AravisCamera.open(bench.simulated.camera.address).close)


def before_block(name: str, act: Callable[[], None]) -> OnProgress:
    """Return a listener that acts once, before the camera is asked for the frames of `name`."""
    acted: list[bool] = []

    def listen(progress: Progress) -> None:
        if progress.doing.startswith(f"recording {name}") and not acted:
            acted.append(True)
            act()

    return listen


# Which packets are lost is chance: the leader's, some, or all; a busy machine adds to it.
LOST = r"\(the last: (missing-packets(, its leader too)?|never came|underrun: .*)\); mend the link"

FAULTS = {
    "most packets lost": (_lose_packets, "frames-lost", LOST),
    "no frames any more": (_stall, "frame-timeout", "firewall"),
    "server killed": (_die, "control-lost", "check power and cable"),
}


@pytest.mark.parametrize(("inject", "code", "said"), FAULTS.values(), ids=FAULTS)
def test_a_fault_ends_dark_in_one_sentence_and_the_run_goes_on_once_it_is_mended(
    gige, out, inject, code, said
):
    with ExitStack() as mending:
        check_fault(gige, out, before_block("001", lambda: inject(gige, mending)), code, said)
    check_goes_on(gige, out)


def test_control_that_is_taken_ends_dark_in_one_sentence_and_the_run_goes_on_once_it_is_free(
    gige, out
):
    """Taken within a block; until it is, the camera sends no frame that would end that block."""
    with ExitStack() as mending:
        stall = before_block("001", lambda: _stall(gige, mending))
        take = at_frame(8 + FRAMES_BEFORE, lambda: _take_control(gige, mending))

        def listen(progress: Progress) -> None:
            stall(progress)
            take(progress)

        check_fault(gige, out, listen, "control-lost", "another program took control")
    check_goes_on(gige, out)


def check_fault(bench: Bench, out: Path, listen: OnProgress, code: str, said: str) -> None:
    with pytest.raises(DarkflatError) as caught:
        run_plan(bench, PLAN, out, on_progress=listen)
    assert caught.value.code == code, caught.value
    assert re.search(said, str(caught.value)), caught.value
    assert "\n" not in str(caught.value)
    assert_dark(bench.world)
    assert whole_blocks(out) == {"000": 256}


def check_goes_on(bench: Bench, out: Path) -> None:
    assert run_plan(bench, PLAN, out, resume=True).state == "succeeded"
    assert whole_blocks(out) == EVERY_BLOCK


def test_few_lost_packets_cost_frames_that_are_named_and_taken_again(gige, out):
    # About one frame in ten: by chance some block may lose more than the usual limit.
    anything = {"max_lost_percent": 100.0}
    plan = short_plan(
        camera=PLAN.camera.model_dump(), lines=1024, frame_lines=32, interlocks=anything
    )
    gige.simulated.camera.lose_packets(0.025)
    try:
        result = run_plan(gige, plan, out)
    finally:
        gige.simulated.camera.lose_packets(0.0)
    assert result.state == "succeeded"
    assert whole_blocks(out) == dict.fromkeys(EVERY_BLOCK, 1024)
    lost = FileRecording(out).commits.lost
    assert len(lost) == result.lost_frames > 0


def test_a_second_program_finds_the_camera_in_use(gige):
    from drivers.aravis.camera import AravisCamera

    with pytest.raises(DarkflatError) as caught:
        AravisCamera.open(gige.simulated.camera.address)
    assert caught.value.code == "device-busy"
