import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from calib.recording.file_recording import FileRecording
from calib.recording.header import CameraHeader
from calib.recording.writer import RecordingWriter
from tests.calib.recording.examples import codes

N_BLOCKS, N_FRAMES = 4, 12


def start(path: Path, lines: int, columns: int, limit: int = 0) -> subprocess.Popen[str]:
    module = "tests.calib.recording.recording_child"
    counts = map(str, (N_BLOCKS, N_FRAMES, lines, columns, limit))
    return subprocess.Popen(
        [sys.executable, "-m", module, str(path), *counts],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def run_and_kill(path: Path, lines: int, columns: int, after_s: float) -> set[int]:
    """Return the indices that were acknowledged before kill -9."""
    with start(path, lines, columns) as child:
        assert child.stdout is not None
        first = child.stdout.readline()
        time.sleep(after_s)
        child.kill()
        rest, complaints = child.communicate()
    assert not complaints
    # A line that the kill tore in the pipe is no acknowledgement.
    return {int(line) for line in (first + rest).split("\n")[:-1]}


def kill_until_done(path: Path, lines: int, columns: int, n_kills: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    acknowledged: set[int] = set()
    for _ in range(n_kills):
        acknowledged |= run_and_kill(path, lines, columns, rng.uniform(0, 0.03))
        seen = FileRecording(path)  # before anything is mended
        assert acknowledged <= {frame.index for frame in seen.commits.every_frame}
    child = start(path, lines, columns)
    _, complaints = child.communicate(timeout=60)
    assert (child.returncode, complaints) == (0, "")
    finished = FileRecording(path)
    assert acknowledged <= {frame.index for frame in finished.commits.every_frame}
    assert [block.block for block in finished.header.blocks] == [
        f"{k:03d}" for k in range(N_BLOCKS)
    ]
    camera = CameraHeader(columns=columns, bit_depth=12)
    for block in finished.header.blocks:
        read = np.concatenate(list(finished.frames(block.block)))
        assert np.array_equal(read, codes(block.block, N_FRAMES * lines, camera))


@pytest.mark.parametrize(
    ("lines", "columns"),
    [
        pytest.param(16, 64, id="small chunks"),
        pytest.param(300, 4096, id="chunks beyond the cache"),
    ],
)
def test_kill_9_loses_no_acknowledged_frame(tmp_path: Path, lines: int, columns: int) -> None:
    kill_until_done(tmp_path / "a.h5", lines, columns, n_kills=3, seed=lines)


@pytest.mark.soak
@pytest.mark.parametrize("seed", range(10))
def test_two_hundred_kills_lose_no_acknowledged_frame(tmp_path: Path, seed: int) -> None:
    kill_until_done(tmp_path / "a.h5", 64, 2048, n_kills=20, seed=seed)


def test_a_file_that_grows_too_large_is_salvageable(tmp_path: Path) -> None:
    path = tmp_path / "a.h5"
    with start(path, 100, 1000, limit=3_000_000) as child:
        out, complaint = child.communicate(timeout=60)
    acknowledged = [int(line) for line in out.split()]
    assert complaint.strip() == "disk-full"
    assert 0 < len(acknowledged) < N_BLOCKS * N_FRAMES
    kill_until_done(path, 100, 1000, n_kills=0, seed=0)
    frames = {frame.index for frame in FileRecording(path).commits.every_frame}
    assert frames >= set(acknowledged)


def test_resume_notes_the_gap_and_the_block_done_again(tmp_path: Path) -> None:
    path = tmp_path / "a.h5"
    run_and_kill(path, 16, 64, after_s=0.0)
    unfinished = FileRecording(path).commits.unfinished
    with RecordingWriter.resume(path) as writer:
        note = writer.notes[-1]
    assert "resumed after a gap of" in note
    assert unfinished is None or f"block {unfinished.block.block} is done again" in note
