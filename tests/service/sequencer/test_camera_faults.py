"""What goes wrong with a GigE Vision camera in the middle of a run: see docs/faults.md."""

import importlib.util
import os
import re
from collections.abc import Callable, Iterator
from contextlib import ExitStack

import pytest

from calib.errors import DarkflatError
from calib.recording.file_recording import FileRecording
from service.bench import Bench, BenchSettings, open_bench
from service.sequencer.run import run_plan
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
    quick["simulation"]["camera_wait_s"] = 240.0  # other tests may be at the address
    with open_bench(BenchSettings.parse(quick)) as bench:
        yield bench


def _lose_packets(bench: Bench) -> Callable[[], None]:
    bench.simulated.camera.lose_packets(0.7)
    return lambda: bench.simulated.camera.lose_packets(0.0)


def _stall(bench: Bench) -> Callable[[], None]:
    bench.simulated.camera.stall()
    return bench.simulated.camera.resume


def _kill(bench: Bench) -> Callable[[], None]:
    bench.simulated.camera.kill()
    return bench.simulated.camera.start


def _take_control(bench: Bench) -> Callable[[], None]:
    from drivers.aravis.camera import AravisCamera

    bench.camera._held().camera.get_device().leave_control()
    return AravisCamera.open(bench.simulated.camera.address).close


# Which packets are lost is chance: the leader's, some, or all; a busy machine adds to it.
LOST = r"\(the last: (missing-packets(, its leader too)?|never came|underrun: .*)\); mend the link"

FAULTS = {
    "most packets lost": (_lose_packets, "frames-lost", LOST),
    "no frames any more": (_stall, "frame-timeout", "firewall"),
    "server killed": (_kill, "control-lost", "check power and cable"),
    "control taken": (_take_control, "control-lost", "another program took control"),
}


@pytest.mark.parametrize(("inject", "code", "said"), FAULTS.values(), ids=FAULTS)
def test_a_fault_ends_dark_in_one_sentence_and_the_run_goes_on_once_it_is_mended(
    gige, out, inject, code, said
):
    with ExitStack() as mending:
        with pytest.raises(DarkflatError) as caught:
            run_plan(
                gige, PLAN, out, on_progress=at_frame(12, lambda: mending.callback(inject(gige)))
            )
        assert caught.value.code == code
        assert re.search(said, str(caught.value))
        assert "\n" not in str(caught.value)
        assert_dark(gige.world)
        assert whole_blocks(out) == {"000": 256}
    assert run_plan(gige, PLAN, out, resume=True).state == "succeeded"
    assert whole_blocks(out) == EVERY_BLOCK


def test_few_lost_packets_cost_frames_that_are_named_and_taken_again(gige, out):
    # About one frame in twelve: by chance some block may lose more than the usual limit.
    anything = {"max_lost_percent": 100.0}
    plan = short_plan(
        camera=PLAN.camera.model_dump(), lines=1024, frame_lines=32, interlocks=anything
    )
    gige.simulated.camera.lose_packets(0.02)
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
