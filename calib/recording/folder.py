"""Importing a recording folder into a file, and exporting one as a folder."""

import json
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Literal

import numpy as np

from calib.arrays import RawLines
from calib.errors import InputError
from calib.recording.commit_log import commit_path
from calib.recording.conditions_csv import conditions_to_csv
from calib.recording.durable import new_folder
from calib.recording.file_recording import FileRecording
from calib.recording.folder_recording import FolderRecording
from calib.recording.formats.catalogue import FORMATS
from calib.recording.frame_codes import code_type, sample_shape
from calib.recording.frame_record import FrameRecord
from calib.recording.header import Block
from calib.recording.new_recording import new_recording
from calib.recording.protocol import Recording
from calib.recording.recording_toml import header_to_toml
from calib.recording.writer import RecordingWriter

FrameFormatName = Literal["npy", "tif", "fits", "raw"]
Progress = Callable[[float], None]
"""Called with the fraction done, 0 … 1."""

_FRAME_BYTES = 8 << 20


def import_folder(
    folder: Path | str, out: Path | str, *, progress: Progress | None = None
) -> FileRecording:
    """Write the recording in `folder` to the .h5 file `out` and its commit record.

    Unknown keys and empty cells are kept. Nothing is left behind where it fails: InputError for
    bad input, DiskFullError where there is no room.
    """
    source, out = FolderRecording(Path(folder)), Path(out)
    with new_recording(out) as partial:
        _copy(source, partial, progress)
    return FileRecording(out)


def _copy(source: FolderRecording, out: Path, progress: Progress | None) -> None:
    camera, before = source.header.camera, source.provenance
    line_bytes = int(np.prod(sample_shape(camera))) * code_type(camera).itemsize
    frame_lines = max(1, _FRAME_BYTES // line_bytes)
    if source.header.blocks[0].lines:
        frame_lines = min(frame_lines, source.header.blocks[0].lines)
    with RecordingWriter.create(
        out, source.header, frame_lines,
        plan=before.plan, features=before.features, scenes=before.scenes,
    ) as writer:  # fmt: skip
        for done, block in enumerate(source.header.blocks, start=1):
            writer.begin_block(block)
            for stretch in source.frames(block.block):
                for first in range(0, len(stretch), frame_lines):
                    writer.append(
                        stretch[first : first + frame_lines],
                        FrameRecord(exposure_us=block.exposure_us, level=block.level),
                    )
            writer.end_block(block)
            if progress is not None:
                progress(done / len(source.header.blocks))


def export_folder(
    recording: Recording,
    out: Path | str,
    *,
    frame_format: FrameFormatName = "npy",
    progress: Progress | None = None,
) -> FolderRecording:
    """Write `recording` as a folder `out` in the interchange format and return it opened."""
    if f".{frame_format}" not in FORMATS:
        raise InputError(
            f"{frame_format} is no format of frames: use npy, tif, fits or raw",
            code="frame-format-unknown",
        )
    with new_folder(Path(out)) as folder:
        _write_headers(recording, folder, frame_format)
        (folder / "frames").mkdir()
        for done, block in enumerate(recording.header.blocks, start=1):
            _write_frames(recording, block, folder / "frames" / f"{block.block}.{frame_format}")
            if progress is not None:
                progress(done / len(recording.header.blocks))
    return FolderRecording(Path(out))


def _write_headers(recording: Recording, folder: Path, frame_format: FrameFormatName) -> None:
    header = recording.header
    if frame_format == "raw":
        camera = header.camera.model_copy(update={"dtype": code_type(header.camera).str})
        header = header.model_copy(update={"camera": camera})
    (folder / "recording.toml").write_text(header_to_toml(header), encoding="utf-8")
    (folder / "conditions.csv").write_text(conditions_to_csv(header.blocks), encoding="utf-8")
    if not isinstance(recording, FileRecording | FolderRecording):
        return
    before = recording.provenance
    if before.plan:
        (folder / "plan.toml").write_text(before.plan, encoding="utf-8")
    if before.features:
        (folder / "features.json").write_text(json.dumps(dict(before.features)), encoding="utf-8")
    if before.scenes:
        (folder / "scenes").mkdir()
    for name, radiance in before.scenes.items():
        np.save(folder / "scenes" / f"{name}.npy", radiance)
    if isinstance(recording, FileRecording):
        # Frame by frame: CRC, clocks, read-backs, lost frames, notes. For people; not read again.
        shutil.copyfile(commit_path(recording.path), folder / "frames.jsonl")


def _write_frames(recording: Recording, block: Block, path: Path) -> None:
    n_samples = block.lines or sum(len(dn) for dn in recording.frames(block.block))
    camera = recording.header.camera
    shape = (n_samples, *sample_shape(camera))
    FORMATS[path.suffix].write(
        path, shape, code_type(camera), _counted(recording, block, n_samples)
    )


def _counted(recording: Recording, block: Block, n_samples: int) -> Iterator[RawLines]:
    n_written = 0
    for dn in recording.frames(block.block):
        n_written += len(dn)
        yield dn
    if n_written != n_samples:
        raise InputError(
            f"block {block.block} of {recording.path} has {n_written} lines, but its header says "
            f"{block.lines}: import it again",
            code="lines-mismatch",
        )
