"""What jobs leave for their clients: `jobs/<id>/<name>`, never changed once it is there."""

import re
import shutil
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from calib.recording.durable import sync
from service.store.errors import NotInStoreError

MEDIA_TYPES: Final = {
    ".html": "text/html",
    ".json": "application/json",
    ".toml": "application/toml",
    ".xml": "application/xml",
    ".h5": "application/x-hdf5",
}
"""By the name's end; nothing else is kept."""
_NAME = re.compile(r"[a-z0-9][a-z0-9-]*\.[a-z0-9]+")


@dataclass(frozen=True)
class JobFile:
    """A file that a job left."""

    name: str
    path: Path

    @property
    def media_type(self) -> str:
        """What it is."""
        return MEDIA_TYPES[self.path.suffix]

    @property
    def n_bytes(self) -> int:
        """How long it is."""
        return self.path.stat().st_size


class JobFiles:
    """The folder of all jobs' files. Job ids are those of the store, never a client's text."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def keep(self, job_id: str, made: Path) -> None:
        """Bring the files in the folder `made` to the disk, then under the job's name."""
        files = [path for path in made.glob("*") if _is_ours(path)]
        if not files:
            return
        for each in (*files, made):
            sync(each)
        self._folder.mkdir(parents=True, exist_ok=True)
        made.rename(self._folder / job_id)
        sync(self._folder)

    def of(self, job_id: str) -> tuple[JobFile, ...]:
        """Return a job's files by name; none where it left none."""
        found = sorted((self._folder / job_id).glob("*"))
        return tuple(JobFile(path.name, path) for path in found if _is_ours(path))

    def get(self, job_id: str, name: str) -> JobFile:
        """Return the file of that name; NotInStoreError where there is none."""
        for each in self.of(job_id):
            if each.name == name:
                return each
        msg = f"job {job_id} has no file {name!r}; its `files` names those that it has"
        raise NotInStoreError(msg)

    def clear(self, is_done: Callable[[str], bool]) -> None:
        """Remove the files of jobs that were not done before the service died."""
        for folder in self._folder.glob("*"):
            if not is_done(folder.name):
                shutil.rmtree(folder)


def _is_ours(path: Path) -> bool:
    is_named = _NAME.fullmatch(path.name) is not None and path.suffix in MEDIA_TYPES
    return is_named and path.is_file() and not path.is_symlink()
