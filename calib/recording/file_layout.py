"""What an .h5 recording holds: `frames`, one chunk per frame, and all headers as attributes.

Everything but `frames` is written before SWMR mode begins, because in it nothing can be created.
"""

import json
from collections.abc import Mapping
from contextlib import closing
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from calib.errors import InputError
from calib.recording.frame_codes import code_type, sample_shape
from calib.recording.header import RecordingHeader
from calib.recording.read_access import unreadable
from calib.recording.recording_toml import header_from_toml, header_to_toml
from calib.recording.unfailing_file import UnfailingFile

FORMAT_NAME = "darkflat-recording"
FORMAT_VERSION = 1
_MAX_CHUNK_BYTES = 0xFFFFFFFF


@dataclass(frozen=True)
class Provenance:
    """What came before the first frame.

    Attributes:
        plan: The plan's text, empty where there was none.
        features: Every feature of the camera and its value.
        scenes: Radiance images by name, (n_lines, n_columns) or (n_columns,), in `radiance_unit`.
    """

    plan: str = ""
    features: Mapping[str, str] = field(default_factory=dict)
    scenes: Mapping[str, NDArray[np.float64]] = field(default_factory=dict)


@dataclass(frozen=True)
class FileContents:
    """What stands in the file beside its frames."""

    recording_id: str
    header: RecordingHeader
    header_warnings: tuple[str, ...]
    frame_lines: int
    provenance: Provenance


def create_file(
    path: Path, recording_id: str, header: RecordingHeader, frame_lines: int, before: Provenance
) -> h5py.File:
    """Return a new file in SWMR mode with no frames yet; lines per frame are fixed.

    Raises:
        InputError: `frame-size-invalid`.
        OSError: The file cannot be written.
    """
    kind = code_type(header.camera)
    frame = (frame_lines, *sample_shape(header.camera))
    if frame_lines < 1 or int(np.prod(frame)) * kind.itemsize > _MAX_CHUNK_BYTES:
        raise InputError(
            f"a frame of {frame_lines} lines cannot be recorded: 1 line to 4 GiB it may have",
            code="frame-size-invalid",
        )
    with closing(UnfailingFile(path)) as disk:
        with h5py.File(disk, "w", libver="latest") as file:
            _fill(file, recording_id, header, frame, before)
        disk.check()
    file = h5py.File(path, "r+", libver="latest", locking=False)
    file.swmr_mode = True
    return file


def _fill(
    file: h5py.File,
    recording_id: str,
    header: RecordingHeader,
    frame: tuple[int, ...],
    before: Provenance,
) -> None:
    """Write everything but frames."""
    kind = code_type(header.camera)
    file.attrs.update(
        {
            "format": FORMAT_NAME,
            "format_version": FORMAT_VERSION,
            "id": recording_id,
            "header": header_to_toml(header),
            "plan": before.plan,
            "features": json.dumps(dict(before.features)),
        }
    )
    scenes = file.create_group("scenes")
    for name, radiance in before.scenes.items():
        scenes.create_dataset(name, data=radiance)
    file.create_dataset("frames", (0, *frame), kind, maxshape=(None, *frame), chunks=(1, *frame))


def check_format(file: h5py.File, path: Path) -> None:
    """Raise InputError `not-a-recording` where `file` is some other HDF5 file."""
    if file.attrs.get("format") != FORMAT_NAME or "frames" not in file:
        raise InputError(
            f"{path} is an HDF5 file, but no recording of darkflat: import its frames from a "
            "folder (`darkflat import`)",
            code="not-a-recording",
        )


def read_contents(file: h5py.File, path: Path) -> FileContents:
    """Return what stands in `file` beside its frames."""
    check_format(file, path)
    try:
        attributes: dict[str, Any] = {key: str(value) for key, value in file.attrs.items()}
        header, warnings = header_from_toml(attributes["header"], (), f"{path} header")
        scenes = {name: scene[()] for name, scene in file["scenes"].items()}
        before = Provenance(attributes["plan"], json.loads(attributes["features"]), scenes)
        frame_lines = int(file["frames"].shape[1])
    except (KeyError, OSError, ValueError) as error:
        raise unreadable(path, error) from error
    return FileContents(attributes["id"], header, warnings, frame_lines, before)
