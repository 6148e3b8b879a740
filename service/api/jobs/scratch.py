"""Folders that jobs work in; none outlives its job, or the service that began it."""

import shutil
import uuid
from pathlib import Path

from service.settings import Settings

FILES = "files"
"""In a job's folder, what is kept of it."""
_PREFIX = "job-"


def new_scratch(settings: Settings) -> Path:
    """Make a folder for one job; on the file system that its results are kept on."""
    scratch = settings.work_folder / f"{_PREFIX}{uuid.uuid4().hex}"
    (scratch / FILES).mkdir(parents=True)
    return scratch


def clear_scratch(settings: Settings) -> None:
    """Remove what a service left behind that was killed: of jobs, uploads and deletions."""
    for left_behind in settings.work_folder.iterdir():
        shutil.rmtree(left_behind) if left_behind.is_dir() else left_behind.unlink()
