"""From a GigE Vision camera on loopback to the disk, with live statistics."""

import tempfile
import time
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from benchmarks.cameras import camera_model
from benchmarks.race import Figure
from benchmarks.row import Row
from benchmarks.size import Size
from calib.kernels.line_sums import LineSums
from calib.kernels.sums import line_sums
from calib.recording.frame_record import FrameRecord
from calib.recording.header import Block, RecordingHeader
from calib.recording.writer import RecordingWriter
from drivers.aravis.camera import AravisCamera
from drivers.aravis.simulated_process import SimulatedCameraProcess
from drivers.mock.world import World
from drivers.ports import CameraSettings, LostFrame

FRAME_LINES = 256
LEAST_MB_S = 200.0
LOOPBACK_PACKET_BYTES = 16384
N_BUFFERS = 64  # 0.8 s of frames: the disk has its moments
LIMIT_FRAMES = 200


@dataclass
class Recorded:
    """What came, and what of it is on the disk after how long."""

    whole: int = 0
    lost: Counter[str] = field(default_factory=Counter)
    seconds: float = 0.0
    sync_s: float = 0.0


def run(size: Size) -> Row:
    """Record one long block; every frame is committed and added up before the next is taken."""
    frame_mb = FRAME_LINES * size.n_columns * 2 / 1e6
    n_frames = max(2, round(size.recording_s * size.recording_mb_s / frame_mb))
    with tempfile.TemporaryDirectory(dir=size.folder, prefix="darkflat-bench-") as name:
        folder = Path(name)
        done = _record(size, folder, n_frames)
        (folder / "recording.h5").unlink()
        alone_s = _write_alone(size, folder, min(n_frames, LIMIT_FRAMES))
    rate = (done.whole - 1) * frame_mb / done.seconds
    limit = min(n_frames, LIMIT_FRAMES) * frame_mb / alone_s
    return Row(
        work=f"record from GigE Vision to disk, {size.n_columns} x {FRAME_LINES} Mono12, "
        f"{done.seconds:.0f} s, live statistics",
        unit="MB/s",
        ours=rate,
        numpy=None,
        peers={},
        limit=Figure(limit, rate / limit),
        limit_is="writing and committing ready frames, without a camera",
        bound=f">= {LEAST_MB_S:.0f} MB/s for 30 s, nothing lost",
        reached=rate >= LEAST_MB_S and not done.lost,
        notes=(
            f"{done.whole} frames, {done.lost.total()} lost"
            + "".join(f" ({count} {why})" for why, count in done.lost.items()),
            f"the camera was paced at {size.recording_mb_s:.0f} MB/s",
            f"the last fsync took {done.sync_s:.1f} s",
        ),
    )


def _record(size: Size, folder: Path, n_frames: int) -> Recorded:
    line_period_us = size.n_columns * 2 / size.recording_mb_s
    model = camera_model("modern-12bit", size.n_columns)
    model.save(folder / "model.toml")
    world = World.create(folder / "world", n_lamps=6)
    for lamp in range(3):
        world.drive(lamp, 1.0)
    settings = CameraSettings(
        exposure_us=0.5 * line_period_us,
        line_period_us=line_period_us,
        frame_lines=FRAME_LINES,
        n_columns=size.n_columns,
    )
    with SimulatedCameraProcess(folder / "model.toml", folder / "world", wait_s=60.0) as process:
        camera = AravisCamera.open(
            process.address, packet_size=LOOPBACK_PACKET_BYTES, n_buffers=N_BUFFERS
        )
        try:
            settings = camera.configure(settings)
            header = RecordingHeader(camera=model.camera, source=model.source)
            with RecordingWriter.create(folder / "recording.h5", header, FRAME_LINES) as writer:
                return _take(camera, writer, settings, n_frames)
        finally:
            camera.close()
            world.close()


def _take(
    camera: AravisCamera, writer: RecordingWriter, settings: CameraSettings, n_frames: int
) -> Recorded:
    block = Block(block="000", kind="flat", exposure_us=settings.exposure_us, level=3)
    done, sums = Recorded(), LineSums.zero(settings.n_columns)
    writer.begin_block(block)
    start = time.perf_counter()
    for frame in camera.frames(n_frames):
        if isinstance(frame, LostFrame):
            writer.lost(block.block, frame.reason, frame.frame_id)
            done.lost[frame.reason] += 1
            continue
        if done.whole == 0:
            start = time.perf_counter()
        writer.append(frame.dn, FrameRecord(frame_id=frame.frame_id))
        sums += line_sums(frame.dn, 4095)
        done.whole += 1
    done.seconds = time.perf_counter() - start
    writer.end_block(block)
    done.sync_s = time.perf_counter() - start - done.seconds
    assert sums.n_lines == done.whole * settings.frame_lines
    return done


def _write_alone(size: Size, folder: Path, n_frames: int) -> float:
    """Return the seconds that writing and committing takes without a camera."""
    model = camera_model("modern-12bit", size.n_columns)
    dn = np.random.default_rng(1).integers(0, 4096, (FRAME_LINES, size.n_columns), np.uint16)
    header = RecordingHeader(camera=model.camera, source=model.source)
    with RecordingWriter.create(folder / "alone.h5", header, FRAME_LINES) as writer:
        writer.begin_block(Block(block="000", kind="flat", exposure_us=10.0, level=3))
        start = time.perf_counter()
        for _ in range(n_frames):
            writer.append(dn)
        return time.perf_counter() - start
