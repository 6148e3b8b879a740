"""Python, the packages, and where compiled loops are kept."""

import os
import re
import sys
from importlib.metadata import PackageNotFoundError, requires, version
from pathlib import Path

from service.doctor.finding import Finding

_OLDEST = (3, 11)


def look_at_python() -> list[Finding]:
    """Return what was found about the interpreter and the packages."""
    return [_python(), *_packages(), _numba_cache()]


def _python() -> Finding:
    found = ".".join(str(part) for part in sys.version_info[:3])
    if sys.version_info < _OLDEST:
        return Finding("Python", "missing", found, "apt-get install python3.11 python3.11-venv")
    return Finding("Python", "ok", f"{found} at {sys.executable}")


def _packages() -> list[Finding]:
    """Look for every package that darkflat itself declares, its extras apart."""
    try:
        wanted = requires("darkflat") or []
    except PackageNotFoundError:
        return [Finding("packages", "missing", "darkflat is not installed", "make setup")]
    names = [
        match[0]
        for each in wanted
        if "extra ==" not in each and (match := re.match(r"[\w.-]+", each)) is not None
    ]
    missing = [name for name in names if not _is_installed(name)]
    if missing:
        remedy = f"{sys.executable} -m pip install {' '.join(missing)}"
        return [Finding("packages", "missing", f"not installed: {', '.join(missing)}", remedy)]
    return [Finding("packages", "ok", f"all {len(names)} are installed")]


def _is_installed(name: str) -> bool:
    try:
        return bool(version(name))
    except PackageNotFoundError:
        return False


def _numba_cache() -> Finding:
    """Compiled loops are kept beside the source, or in the user's cache, or where told."""
    told = os.environ.get("NUMBA_CACHE_DIR")
    beside = Path(__file__).parents[2] / "calib" / "kernels"
    places = [Path(told)] if told else [beside, Path("~/.cache").expanduser()]
    for place in places:
        if is_writable(place):
            return Finding("compiled loops", "ok", f"kept in {place}")
    text = f"cannot be kept in {' or '.join(map(str, places))}: every start compiles anew"
    return Finding("compiled loops", "advice", text, "export NUMBA_CACHE_DIR=/a/writable/folder")


def is_writable(path: Path) -> bool:
    """Tell whether a file can be made in `path`, or `path` itself where it is not there yet."""
    existing = path
    while not existing.exists() and existing != existing.parent:
        existing = existing.parent
    return existing.is_dir() and os.access(existing, os.W_OK | os.X_OK)
