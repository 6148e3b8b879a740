"""What a resumed run draws is independent of what was drawn before, on a seeded bench too."""

import os
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from calib.recording.file_recording import FileRecording
from service.bench import open_bench
from service.bench.settings import BenchSettings
from service.sequencer.run import run_plan
from tests.contracts.simulated_camera import ADDRESS_WAIT_S
from tests.service.sequencer.benches import in_process, short_plan

SEED = 11


def seeded(bench_id: str, **changes: object) -> BenchSettings:
    content = in_process(f"{os.getpid()}-{bench_id}").model_dump()
    content["simulation"] |= {"seed": SEED, "camera_wait_s": ADDRESS_WAIT_S}
    return BenchSettings.parse({**content, **changes})


def frames_after_opening(settings: BenchSettings, out: Path, *, stop_at: int | None) -> None:
    """Run or go on with the plan on a bench that is opened for it, up to `stop_at` frames."""
    seen: list[object] = []
    with open_bench(settings) as bench:
        run_plan(
            bench,
            PLAN,
            out,
            resume=out.exists(),
            cancelled=lambda: stop_at is not None and len(seen) >= stop_at,
            on_columns=seen.append,
        )


PLAN = short_plan(lines=128, frame_lines=32)
"""Dark, flat, dark, flat; four frames each."""


def residuals(out: Path, block: str) -> NDArray[np.float64]:
    """Each sample less its column's mean: the noise, and nothing that both attempts share."""
    dn = np.concatenate(list(FileRecording(out).frames(block))).astype(float)
    residual: NDArray[np.float64] = dn - dn.mean(axis=0)
    return residual.ravel()


def check_independent(first: NDArray[np.float64], second: NDArray[np.float64]) -> None:
    """Repeated noise correlates by 1; 6 standard errors come by chance once in 500 million runs."""
    correlation = np.corrcoef(first, second)[0, 1]
    assert abs(correlation) < 6 / np.sqrt(first.size)


def two_attempts(
    settings: BenchSettings, out: Path
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the residuals of the two darks, each the first block of its attempt."""
    frames_after_opening(settings, out, stop_at=8)
    assert {block.block for block in FileRecording(out).header.blocks} == {"000", "001"}
    frames_after_opening(settings, out, stop_at=None)
    return residuals(out, "000"), residuals(out, "002")


def test_two_attempts_on_a_seeded_bench_share_no_noise(tmp_path: Path) -> None:
    check_independent(*two_attempts(seeded("mock"), tmp_path / "a.h5"))


def test_first_attempts_on_a_seeded_bench_draw_the_same_noise(tmp_path: Path) -> None:
    outs = tmp_path / "a.h5", tmp_path / "b.h5"
    for out in outs:
        frames_after_opening(seeded("same"), out, stop_at=4)
    np.testing.assert_array_equal(residuals(outs[0], "000"), residuals(outs[1], "000"))


@pytest.mark.aravis
def test_two_attempts_over_gige_vision_share_no_noise(tmp_path: Path) -> None:
    settings = seeded("gige", camera={"driver": "aravis"})
    check_independent(*two_attempts(settings, tmp_path / "a.h5"))


@pytest.mark.parametrize("driver", ["mock", "keithley6485"])
def test_monitors_draw_afresh_too(driver: str) -> None:
    readings_a = []
    for _ in range(2):
        with open_bench(seeded(driver, monitor={"driver": driver})) as bench:
            assert bench.simulated is not None
            assert bench.monitor is not None
            bench.simulated.draw_afresh()
            readings_a.append([bench.monitor.read().current_a for _ in range(3)])
    assert readings_a[0] != readings_a[1]
