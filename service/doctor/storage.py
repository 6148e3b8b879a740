"""Room for recordings, and a place for the store."""

import shutil
from pathlib import Path

from service.doctor.finding import Finding
from service.doctor.python import is_writable
from service.settings import Settings

_FULL_SWEEP_BYTES = 5 << 30
_LEAST_BYTES = 1 << 28


def look_at_storage(settings: Settings, folder: Path) -> list[Finding]:
    """Return what was found about the disk under `folder` and about the store's home."""
    return [_room(folder), _home(settings)]


def _room(folder: Path) -> Finding:
    free = shutil.disk_usage(folder).free
    text = f"{free / 1e9:.1f} GB free here"
    if free < _LEAST_BYTES:
        return Finding("disk", "missing", text, f"free some room on the disk of {folder}")
    if free < _FULL_SWEEP_BYTES:
        remedy = "free some room, or record on another disk (--out)"
        return Finding("disk", "advice", f"{text}: too little for a long sweep", remedy)
    return Finding("disk", "ok", text)


def _home(settings: Settings) -> Finding:
    if not is_writable(settings.home):
        remedy = "export DARKFLAT_HOME=/a/writable/folder"
        return Finding("store", "missing", f"{settings.home} is not writable", remedy)
    return Finding("store", "ok", settings.store_url or str(settings.home))
