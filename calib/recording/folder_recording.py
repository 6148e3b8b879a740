"""Reading a recording folder: recordings made elsewhere, and ours when exported."""

import json
from collections.abc import Iterator
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from calib.arrays import RawLines
from calib.errors import InputError, NotDeterminedError, reason_of
from calib.recording.conditions_csv import read_conditions
from calib.recording.digest import digest_of
from calib.recording.file_layout import Provenance
from calib.recording.folder_frames import find_frames, open_frames
from calib.recording.frame_codes import checked_codes
from calib.recording.header import RecordingHeader
from calib.recording.read_access import not_found
from calib.recording.recording_toml import header_from_toml
from calib.recording.scene_images import read_scene
from calib.recording.statistics_csv import StatisticsRow, read_statistics

# A stretch of lines; memory does not grow with the number of lines.
_STRETCH_BYTES = 32 << 20


class FolderRecording:
    """`recording.toml`, `conditions.csv` and `frames/`, or `statistics.csv` in their place."""

    def __init__(self, path: Path) -> None:
        """Open the folder and look at every file's header; codes are checked when read."""
        self._path = path
        _check_folder(path)
        blocks, warnings = read_conditions(path / "conditions.csv")
        self._header, odd = header_from_toml(
            _text_of(path / "recording.toml"), blocks, str(path / "recording.toml")
        )
        self._statistics: tuple[StatisticsRow, ...] = ()
        self._files: dict[str, Path] = {}
        if (path / "frames").is_dir():
            self._files, ignored = find_frames(path / "frames", self._header)
            warnings = (*warnings, *ignored)
        elif (path / "statistics.csv").exists():
            names = tuple(block.block for block in blocks)
            self._statistics = read_statistics(path / "statistics.csv", names)
        else:
            raise InputError(
                f"{path} has neither frames/ nor statistics.csv: add the one that there is",
                code="recording-incomplete",
            )
        self._warnings = (*odd, *warnings)

    @property
    def path(self) -> Path:
        """The folder."""
        return self._path

    @property
    def header(self) -> RecordingHeader:
        """Camera, source and blocks."""
        return self._header

    @property
    def warnings(self) -> tuple[str, ...]:
        """What was odd but usable; one sentence each."""
        return self._warnings

    @property
    def statistics(self) -> tuple[StatisticsRow, ...]:
        """The rows of `statistics.csv`; empty where there are frames."""
        return self._statistics

    @cached_property
    def scenes(self) -> dict[str, NDArray[np.float64]]:
        """Radiance images by name, as the blocks name them."""
        names = dict.fromkeys(block.scene for block in self._header.blocks if block.scene)
        columns = self._header.camera.columns
        return {name: read_scene(self._path / "scenes", name, columns) for name in names}

    @property
    def provenance(self) -> Provenance:
        """The plan (plan.toml) and the camera's features (features.json), where there are any."""
        plan, features = self._path / "plan.toml", self._path / "features.json"
        if not plan.exists():
            plan = self._path / "plan.txt"  # its name in earlier exports
        try:
            known: dict[str, Any] = json.loads(_text_of(features)) if features.exists() else {}
        except ValueError as error:
            raise InputError(
                f"{features} is not JSON ({error}): correct it, or move it away",
                code="features-invalid",
            ) from error
        return Provenance(_text_of(plan) if plan.exists() else "", known, self.scenes)

    def frames(self, block: str) -> Iterator[RawLines]:
        """Yield stretches of lines, (n_lines, n_columns), or (n_frames, n_rows, n_columns).

        Raises NotDeterminedError `frames-missing` where only `statistics.csv` survives.
        """
        if self._statistics:
            raise NotDeterminedError(
                f"{self._path} holds statistics.csv alone: this needs frames/{block}.npy",
                code="frames-missing",
            )
        if block not in self._files:
            raise InputError(f"{self._path} has no block {block}", code="block-not-found")
        return self._stretches(self._files[block])

    def _stretches(self, path: Path) -> Iterator[RawLines]:
        camera = self._header.camera
        file = open_frames(path, camera)
        step = max(1, _STRETCH_BYTES // (int(np.prod(file.shape[1:])) * file.dtype.itemsize))
        for first in range(0, file.shape[0], step):
            dn = file.stretch(first, min(first + step, file.shape[0]))
            yield checked_codes(dn, camera, str(path))

    def digest(self) -> str:
        """SHA-256 over header and frames, the same for a file and its exported folder."""
        return digest_of(self)


def _check_folder(path: Path) -> None:
    if not path.exists():
        raise not_found(path)
    if not path.is_dir():
        raise InputError(
            f"{path} is no folder: name the folder that holds recording.toml, conditions.csv and "
            "frames/",
            code="not-a-folder",
        )


def _text_of(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8")
    except FileNotFoundError as error:
        raise InputError(
            f"{path.name} is missing in {path.parent}: add it", code="recording-incomplete"
        ) from error
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(
            f"{path} cannot be read ({reason_of(error)}): save it as UTF-8 text",
            code="header-invalid",
        ) from error
