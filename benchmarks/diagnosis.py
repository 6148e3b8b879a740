"""The diagnosis of a recording, against reading it; of a full-size one with the memory it takes."""

import os
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from benchmarks.cameras import camera_model
from benchmarks.race import race
from benchmarks.row import Row
from benchmarks.size import Size
from calib.diagnosis.diagnose import diagnose
from calib.forward.simulate import simulate
from calib.recording.header import Block, RecordingHeader
from calib.recording.open import open_recording
from calib.recording.writer import RecordingWriter

ROOT = str(Path(__file__).parents[1])
PRESET = "modern-12bit"
COLUMNS, LINES = 2048, 137
TO_REACH_S, FULL_TO_REACH_S, FULL_TO_REACH_GB = 2.0, 60.0, 2.0
FEW = [(level, exposure) for level in (0, 1, 2, 3, 4, 5) for exposure in (10.0, 30.0, 50.0)]
MANY = [(0, 10.0), *((level, 10.0 * k) for level in range(6) for k in (1, 2, 3, 4, 5))]


def of_5_mpix(size: Size) -> Row:
    """2,048 columns, 18 blocks of 137 lines, in this process."""
    columns, lines = min(COLUMNS, size.n_columns), min(LINES, size.n_lines)
    with tempfile.TemporaryDirectory(dir=size.folder, prefix="darkflat-bench-") as folder:
        path = Path(folder) / "recording.h5"
        record(path, FEW, columns, lines)
        mpix = len(FEW) * columns * lines / 1e6
        figures = race(
            mpix,
            {"ours": lambda: diagnose(open_recording(path)), "limit": lambda: _read(path)},
            rounds=min(size.rounds, 5),
        )
    seconds = mpix / figures["ours"].rate
    return Row(
        work=f"diagnose {columns} x {lines} x {len(FEW)} blocks",
        unit="Mpix/s",
        ours=figures["ours"].rate,
        numpy=None,
        peers={},
        limit=figures["limit"],
        limit_is="reading the recording, every frame's CRC verified",
        bound=f"< {TO_REACH_S:g} s",
        reached=seconds < TO_REACH_S,
        notes=(f"{seconds:.2f} s",),
    )


def of_full_size(size: Size) -> Row:
    """31 blocks by the command, its start included."""
    with tempfile.TemporaryDirectory(dir=size.folder, prefix="darkflat-bench-") as folder:
        path = Path(folder) / "recording.h5"
        record(path, MANY, size.n_columns, size.n_lines)
        mpix = len(MANY) * size.frame_pixels / 1e6
        peak_gb = 0.0

        def ours() -> None:
            nonlocal peak_gb
            peak_gb = max(peak_gb, _by_command(path))

        contestants = {"ours": ours, "limit": lambda: _read(path)}
        figures = race(mpix, contestants, rounds=min(size.rounds, 2))
    seconds = mpix / figures["ours"].rate
    return Row(
        work=f"darkflat diagnose, {size.frame} x {len(MANY)} blocks",
        unit="Mpix/s",
        ours=figures["ours"].rate,
        numpy=None,
        peers={},
        limit=figures["limit"],
        limit_is="reading the recording, every frame's CRC verified",
        bound=f"< {FULL_TO_REACH_S:g} s and < {FULL_TO_REACH_GB:g} GB",
        reached=seconds < FULL_TO_REACH_S and peak_gb < FULL_TO_REACH_GB,
        notes=(f"{seconds:.1f} s", f"{peak_gb:.2f} GB at most"),
    )


def record(path: Path, plan: list[tuple[int, float]], columns: int, lines: int) -> None:
    """Record a block of one frame for each level and exposure (µs) of `plan`."""
    model = camera_model(PRESET, columns)
    blocks = [
        Block(
            block=f"{k:03d}", kind="flat" if level else "dark", exposure_us=exposure,
            level=level, lines=lines,
        )
        for k, (level, exposure) in enumerate(plan)
    ]  # fmt: skip
    header = RecordingHeader(camera=model.camera, source=model.source)
    with RecordingWriter.create(path, header, lines) as writer:
        for block, frames in simulate(model, blocks, np.random.default_rng(1), frame_lines=lines):
            writer.begin_block(block)
            for dn in frames:
                writer.append(dn)
            writer.end_block(block)


def _by_command(path: Path) -> float:
    """Return the most memory that the command held, GB."""
    subprocess.run(
        [sys.executable, "-c", _COMMAND, "diagnose", str(path)],
        check=True, capture_output=True, env={**os.environ, "PYTHONPATH": ROOT},
    )  # fmt: skip
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * 1024 / 1e9


_COMMAND = "from service.cli import main; main()"


def _read(path: Path) -> None:
    recording = open_recording(path)
    for block in recording.header.blocks:
        for _ in recording.frames(block.block):
            pass
