"""The same run over real protocols: GigE Vision on loopback, controllers on pseudo-terminals."""

import importlib.util
import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from calib.errors import DarkflatError
from calib.recording.file_recording import FileRecording
from service.bench import Bench, BenchSettings, open_bench
from service.sequencer.run import run_plan
from tests.contracts.simulated_camera import ADDRESS_WAIT_S
from tests.service.sequencer.benches import assert_dark, short_plan, whole_blocks

pytestmark = [
    pytest.mark.aravis,
    pytest.mark.skipif(importlib.util.find_spec("gi") is None, reason="PyGObject is not there"),
]

PLAN = short_plan(
    camera={"line_period_us": 400.0},
    lines=128,
    frame_lines=32,
    settle={"tolerance_percent": 5.0, "stable_for_s": 0.2, "interval_s": 0.05, "timeout_s": 20.0},
)


def over_protocols(name: str, world: Path | None = None) -> BenchSettings:
    return BenchSettings.parse(
        {
            "id": f"protocols-{os.getpid()}-{name}",
            "camera": {"driver": "aravis"},
            "light": {"driver": "gen", "ramp_step_a": 2.0, "ramp_step_s": 0.01},
            "monitor": {"driver": "keithley6485"},
            "shutter": {"driver": "rly16"},
            "simulation": {
                "model": "demo",
                "lamps": 1,
                "warm_up_s": 0.05,
                "baudrate": 115200,
                "camera_wait_s": ADDRESS_WAIT_S,
                "world": world,
            },
        }
    )


@pytest.fixture(scope="class")
def wired() -> Iterator[Bench]:
    with open_bench(over_protocols("module")) as bench:
        yield bench


class TestWiredBench:
    """One bench for all: it takes seconds to start, and its camera has one address."""

    def test_a_sweep_over_gige_vision_and_serial_lines_is_whole_and_ends_dark(
        self, wired, tmp_path
    ):
        out = tmp_path / "sweep.h5"
        result = run_plan(wired, PLAN, out)
        assert (result.state, result.blocks_done, result.frames) == ("succeeded", 4, 16)
        assert whole_blocks(out) == dict.fromkeys(("000", "001", "002", "003"), 128)
        assert_dark(wired.world)
        dark, flat = FileRecording(out).header.blocks[:2]
        assert (
            flat.model_extra["brightest_column_dn"] > dark.model_extra["brightest_column_dn"] + 50
        )
        assert flat.exposure_us == pytest.approx(50.0, rel=0.02)
        assert flat.monitor > 0
        assert flat.model_extra["lamp_currents_a"] == pytest.approx([4.0], abs=0.05)

    def test_a_second_owner_is_refused_while_the_first_measures(self, wired):
        with pytest.raises(DarkflatError, match=f"in use by process {os.getpid()}"):
            open_bench(over_protocols("module"))

    def test_a_recording_made_over_protocols_is_resumed(self, wired, tmp_path):
        out = tmp_path / "sweep.h5"
        frames = []
        run_plan(wired, PLAN, out, cancelled=lambda: len(frames) > 5, on_columns=frames.append)
        assert_dark(wired.world)
        assert len(whole_blocks(out)) == 1
        assert run_plan(wired, PLAN, out, resume=True).blocks_done == 4
