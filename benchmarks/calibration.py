"""AgCam's calibration of a full-size recording, against reading that recording."""

import os
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from benchmarks.cameras import camera_model
from benchmarks.race import race
from benchmarks.row import Row
from benchmarks.size import Size
from benchmarks.timing import OwnTime
from calib.forward.simulate import simulate
from calib.radiometric.calibrate import calibrate
from calib.recording.header import Block, RecordingHeader
from calib.recording.open import open_recording
from calib.recording.writer import RecordingWriter

EXPOSURES_US = {"agcam-nir": (100, 200, 300, 400, 500), "modern-12bit": (10, 20, 30, 40, 50)}
LEVELS = (1, 2, 3, 4, 5)
DARKS = 6
LONGEST_TIMES_READING = 2.0


def of_8_bits(size: Size) -> Row:
    """AgCam's own camera, whose rounding has to be undone."""
    return _row(size, "agcam-nir")


def of_12_bits(size: Size) -> Row:
    """A camera as sold today: twice the bytes."""
    return _row(size, "modern-12bit")


def _row(size: Size, preset: str) -> Row:
    with tempfile.TemporaryDirectory(dir=size.folder, prefix="darkflat-bench-") as folder:
        path = Path(folder) / "recording.h5"
        _record(size, preset, path)
        mbytes = path.stat().st_size / 1e6
        contestants: dict[str, Callable[[], object]] = {
            "ours": lambda: calibrate(open_recording(path)),
            "limit": lambda: _read(path),
        }
        cached = race(mbytes, contestants, rounds=size.rounds)
        from_disk = race(
            mbytes,
            {name: _evicted_before(path, call) for name, call in contestants.items()},
            rounds=size.rounds,
        )
    times = 1 / from_disk["limit"].ours_is
    return Row(
        work=f"calibrate {preset}, {size.frame} x {len(LEVELS) * 5 + DARKS} blocks, from disk",
        unit="MB/s",
        ours=from_disk["ours"].rate,
        numpy=None,
        peers={},
        limit=from_disk["limit"],
        limit_is="reading the recording from disk, every frame's CRC verified",
        bound=f"<= {LONGEST_TIMES_READING:g} x the time of reading",
        reached=times <= LONGEST_TIMES_READING,
        notes=(
            f"takes {times:.2f} x the time of reading",
            f"{mbytes / cached['ours'].rate:.2f} s and {1 / cached['limit'].ours_is:.2f} x the "
            "time of reading where the system still has the file in memory",
        ),
    )


def _record(size: Size, preset: str, path: Path) -> None:
    model = camera_model(preset, size.n_columns)
    flats = [(level, exposure) for level in LEVELS for exposure in EXPOSURES_US[preset]]
    darks = [(0, EXPOSURES_US[preset][k % 5]) for k in range(DARKS)]
    blocks = [
        Block(
            block=f"{k:03d}",
            kind="flat" if level else "dark",
            exposure_us=exposure,
            level=level,
            lines=size.n_lines,
        )
        for k, (level, exposure) in enumerate([*darks, *flats])
    ]
    header = RecordingHeader(camera=model.camera, source=model.source)
    with RecordingWriter.create(path, header, size.n_lines) as writer:
        drawn = simulate(model, blocks, np.random.default_rng(1), frame_lines=size.n_lines)
        for block, frames in drawn:
            writer.begin_block(block)
            for dn in frames:
                writer.append(dn)
            writer.end_block(block)


def _read(path: Path) -> None:
    recording = open_recording(path)
    for block in recording.header.blocks:
        for _ in recording.frames(block.block):
            pass


def _evicted_before(path: Path, call: Callable[[], object]) -> Callable[[], OwnTime]:
    """Return `call` timed from where the system no longer has `path` in memory."""

    def run() -> OwnTime:
        descriptor = os.open(path, os.O_RDONLY)
        os.fsync(descriptor)
        os.posix_fadvise(descriptor, 0, 0, os.POSIX_FADV_DONTNEED)
        os.close(descriptor)
        start = time.perf_counter()
        call()
        return OwnTime(time.perf_counter() - start)

    return run
