"""A PostgreSQL server of the tests' own, on a Unix socket, that forgets everything at the end."""

import os
import pwd
import shutil
import signal
import subprocess
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

_DEBIAN = Path("/usr/lib/postgresql")
_SETTINGS = (
    "listen_addresses=", "fsync=off", "synchronous_commit=off", "full_page_writes=off",
    "shared_buffers=16MB", "max_connections=50",
)  # fmt: skip
_PATIENCE_S = 60.0


def programs() -> Path | None:
    """Return the folder of initdb and postgres; None where PostgreSQL is not installed."""
    found = shutil.which("initdb")
    places = [Path(found).resolve().parent] if found else []
    places += [each / "bin" for each in sorted(_DEBIAN.glob("*"), reverse=True)]
    return next((each for each in places if (each / "initdb").exists()), None)


@contextmanager
def server(bin_folder: Path) -> Iterator[str]:
    """Start a server; give the URL of its databases, without their names."""
    user = _user()
    folder = Path(tempfile.mkdtemp(prefix="darkflat-pg-", dir="/tmp"))
    try:
        shutil.chown(folder, user)
        _initialise(bin_folder, folder, user)
        settings = [f"-c{each}" for each in (*_SETTINGS, f"unix_socket_directories={folder}")]
        with (folder / "log").open("wb") as log, subprocess.Popen(
            [bin_folder / "postgres", "-D", folder / "data", *settings],
            cwd=folder, stdout=log, stderr=log, **_as(user),
        ) as running:  # fmt: skip
            try:
                _wait_until_it_answers(bin_folder, folder, running)
                yield f"postgresql+psycopg://tests@/{{name}}?host={folder}"
            finally:
                running.send_signal(signal.SIGQUIT)  # at once, with whoever is connected
                try:
                    running.wait(_PATIENCE_S)
                except subprocess.TimeoutExpired:
                    running.kill()
    finally:
        shutil.rmtree(folder)


def _initialise(bin_folder: Path, folder: Path, user: str) -> None:
    done = subprocess.run(
        [
            bin_folder / "initdb", "-D", folder / "data", "--auth=trust", "--encoding=UTF8",
            "--locale=C", "--no-sync", "-U", "tests",
        ],
        cwd=folder, check=False, capture_output=True, text=True, **_as(user),
    )  # fmt: skip
    assert done.returncode == 0, done.stderr


def _wait_until_it_answers(
    bin_folder: Path, folder: Path, running: "subprocess.Popen[bytes]"
) -> None:
    until_s = time.monotonic() + _PATIENCE_S
    while subprocess.run([bin_folder / "pg_isready", "-q", "-h", folder], check=False).returncode:
        assert running.poll() is None, (folder / "log").read_text()
        assert time.monotonic() < until_s, "PostgreSQL does not answer"
        time.sleep(0.05)


def _as(user: str) -> dict[str, Any]:
    """Return what makes a process the user's, where this one is root's."""
    return {} if os.geteuid() else {"user": user, "group": user, "extra_groups": ()}


def _user() -> str:
    """Return whose server it is: PostgreSQL refuses to be root's."""
    if os.geteuid():
        return pwd.getpwuid(os.geteuid()).pw_name
    return "postgres"  # whom the package makes
