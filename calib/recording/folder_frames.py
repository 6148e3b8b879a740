"""Which file under `frames/` belongs to which block, and whether it fits its header."""

from collections.abc import Iterator
from pathlib import Path

from calib.errors import InputError
from calib.recording.formats.catalogue import FORMATS
from calib.recording.formats.frame_file import FrameFile, unreadable
from calib.recording.frame_codes import check_kind
from calib.recording.header import Block, CameraHeader, RecordingHeader


def find_frames(folder: Path, header: RecordingHeader) -> tuple[dict[str, Path], tuple[str, ...]]:
    """Return each block's file and warnings; every file is opened and its header compared."""
    present = sorted(each for each in folder.iterdir() if not each.name.startswith("."))
    frames = [each for each in present if each.suffix.lower() in FORMATS]
    files = {block.block: _file_of(block, frames, folder) for block in header.blocks}
    extra = [each.name for each in frames if each not in files.values()]
    if extra:
        raise InputError(
            f"{folder} holds {', '.join(extra[:3])}{' …' if len(extra) > 3 else ''} that no row of "
            "conditions.csv names: add the row, or move the file away",
            code="frames-extra",
        )
    for block in header.blocks:
        _check_lines(block, files[block.block], open_frames(files[block.block], header.camera))
    return files, tuple(_ignored(present))


def open_frames(path: Path, camera: CameraHeader) -> FrameFile:
    """Open one file of frames; InputError where its type or shape is not the camera's."""
    if not path.is_file():
        raise unreadable(path, "it is no file")
    file = FORMATS[path.suffix.lower()].read(path, camera)
    check_kind(file.dtype, file.shape, camera, str(path))
    return file


def _file_of(block: Block, frames: list[Path], folder: Path) -> Path:
    found = [each for each in frames if each.name[: -len(each.suffix)] == block.block]
    if not found:
        raise InputError(
            f"the frames of block {block.block} are missing in {folder}: put them back as "
            f"{block.block}.npy (or .tif, .fits, .raw), or remove the row from conditions.csv",
            code="frames-missing",
        )
    if len(found) > 1:
        raise InputError(
            f"block {block.block} has several files in {folder}: "
            f"{', '.join(each.name for each in found)}; keep one",
            code="frames-ambiguous",
        )
    return found[0]


def _check_lines(block: Block, path: Path, file: FrameFile) -> None:
    if block.lines is not None and block.lines != file.shape[0]:
        raise InputError(
            f"{path} holds {file.shape[0]} lines, but conditions.csv says {block.lines} for block "
            f"{block.block}: correct the row, or copy the file again",
            code="lines-mismatch",
        )


def _ignored(present: list[Path]) -> Iterator[str]:
    for each in present:
        if each.suffix.lower() not in FORMATS:
            yield f"{each} is no file of frames and is left out"
