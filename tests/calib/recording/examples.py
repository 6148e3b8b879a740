"""Small recordings to test with; every code follows from (seed, block, line)."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from calib.arrays import RawLines
from calib.recording.frame_record import FrameRecord
from calib.recording.header import Block, CameraHeader, RecordingHeader, SourceHeader
from calib.recording.writer import RecordingWriter

HEADER = RecordingHeader(
    camera=CameraHeader(model="LS", serial="B1", columns=48, bit_depth=12, band="NIR"),
    source=SourceHeader(kind="sphere", lamps=6, radiance_unit="W m-2 sr-1"),
)


def codes(
    block: str, lines: int, camera: CameraHeader = HEADER.camera, *, seed: int = 3
) -> NDArray[np.uint8] | NDArray[np.uint16]:
    rng = np.random.default_rng([seed, *block.encode()])
    one = (camera.columns,) if camera.rows is None else (camera.rows, camera.columns)
    drawn = rng.integers(0, camera.full_scale_dn + 1, (lines, *one))
    return drawn.astype(np.uint8) if camera.bit_depth == 8 else drawn.astype(np.uint16)


def blocks(n: int = 3, lines: int | None = 20) -> tuple[Block, ...]:
    return tuple(
        Block(
            block=f"{k:03d}",
            kind="flat" if k else "dark",
            exposure_us=100.0 + k / 3,
            level=float(k),
            started_s=1.5 * k,
            lines=lines,
            radiance=0.1 * k if k else None,
        )
        for k in range(n)
    )


def record(
    writer: RecordingWriter, block: Block, dn: RawLines, frame_lines: int = 8, *, end: bool = True
) -> None:
    writer.begin_block(block)
    for number, first in enumerate(range(0, len(dn), frame_lines)):
        writer.append(dn[first : first + frame_lines], FrameRecord(frame_id=number))
    if end:
        writer.end_block(block)


def write_recording(
    path: Path, header: RecordingHeader = HEADER, wanted: tuple[Block, ...] | None = None
) -> Path:
    with RecordingWriter.create(path, header, 8) as writer:
        for block in wanted if wanted is not None else blocks():
            record(writer, block, codes(block.block, block.lines or 20, header.camera))
    return path
