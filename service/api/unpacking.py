"""Unpacking what somebody else packed: no path of theirs leaves the folder, no bomb goes off."""

import stat
import zipfile
from pathlib import Path, PurePosixPath

from calib.errors import InputError
from service.settings import Settings

_CHUNK = 1 << 20
_DEEPEST = 4


def unpack(archive: Path, folder: Path, settings: Settings) -> None:
    """Unpack the zip file `archive` into the new `folder`, within the limits of an upload.

    Raises:
        InputError: `not-a-zip`; `unsafe-archive` for a path that leads elsewhere, a link, or too
            many files; `too-large` where it unpacks to more than an upload may.
    """
    folder.mkdir()
    try:
        with zipfile.ZipFile(archive) as packed:
            members = packed.infolist()
            if len(members) > settings.max_upload_files:
                msg = f"the archive has more than {settings.max_upload_files} files"
                raise InputError(msg, code="unsafe-archive")
            left = settings.max_upload_bytes
            for member in members:
                target = folder / _safe_name(member)
                if not member.is_dir():
                    left = _extract(packed, member, target, left)
    except (zipfile.BadZipFile, EOFError, NotImplementedError, RuntimeError) as error:
        msg = f"the body is not a zip archive that can be read ({error}); pack it again"
        raise InputError(msg, code="not-a-zip") from error


def _safe_name(member: zipfile.ZipInfo) -> PurePosixPath:
    path = PurePosixPath(member.filename)
    is_link = stat.S_ISLNK(member.external_attr >> 16)
    leads_away = path.is_absolute() or ".." in path.parts or "\\" in member.filename
    if is_link or leads_away or not path.parts or len(path.parts) > _DEEPEST:
        msg = f"the archive holds {member.filename!r}, which does not belong into a recording"
        raise InputError(msg, code="unsafe-archive")
    return path


def _extract(packed: zipfile.ZipFile, member: zipfile.ZipInfo, target: Path, left: int) -> int:
    """Write one file; return how many bytes may still come. The stated sizes are not believed."""
    if target.exists():
        msg = f"the archive holds {member.filename!r} twice"
        raise InputError(msg, code="unsafe-archive")
    target.parent.mkdir(parents=True, exist_ok=True)
    with packed.open(member) as source, target.open("xb") as file:
        while chunk := source.read(_CHUNK):
            left -= len(chunk)
            if left < 0:
                msg = "the archive unpacks to more than this service accepts; import it locally"
                raise InputError(msg, code="too-large")
            file.write(chunk)
    return left
