"""Where darkflat keeps its things and what it accepts; every field is `DARKFLAT_<NAME>`."""

import os
from pathlib import Path
from typing import Self

from pydantic import Field, ValidationError
from pydantic_settings import BaseSettings, SettingsConfigDict

from calib.errors import InputError
from service.watching.log import LogForm


def _data_folder() -> Path:
    """Return where the system keeps a user's data: XDG_DATA_HOME, else ~/.local/share."""
    base = os.environ.get("XDG_DATA_HOME") or "~/.local/share"
    return Path(base).expanduser() / "darkflat"


_NO_NAMES = frozenset({"", "0.0.0.0", "::"})  # noqa: S104  (to listen on, not to ask by)


class Settings(BaseSettings):
    """Read once at the start, from the environment; a typo in a value is an error."""

    model_config = SettingsConfigDict(env_prefix="DARKFLAT_", frozen=True)

    home: Path = Field(default_factory=_data_folder)
    """The folder of coefficient sets, recordings and, by default, the store's SQLite file."""
    store_url: str = ""
    """SQLAlchemy URL of the store; empty: SQLite in `home`."""
    bench: Path | None = None
    """The bench file; None: a simulated bench where one is needed."""
    host: str = "127.0.0.1"
    hosts: str = ""
    """Names beside those of loopback that the service goes by, such as `bench-3.lab,10.0.0.3`."""
    port: int = Field(default=8642, ge=0, le=65535)
    log: LogForm = "text"
    """The form of the log's lines on standard error: for people, or one JSON object per line."""
    max_upload_bytes: int = Field(default=16 << 30, gt=0)
    """Of one recording, as uploaded and once unpacked."""
    max_upload_files: int = Field(default=10_000, gt=0)
    max_frames_bytes: int = Field(default=1 << 30, gt=0)
    """Of the raw lines of one `apply`."""
    max_json_bytes: int = Field(default=32 << 20, gt=0)
    """Of any other body: it is held in memory."""
    max_queued_jobs: int = Field(default=100, gt=0)

    @classmethod
    def load(cls) -> Self:
        """Return the settings of the environment; InputError `bad-setting` names a bad one."""
        try:
            return cls()
        except ValidationError as error:
            first = error.errors()[0]
            name = "_".join(str(part) for part in first["loc"]).upper()
            msg = f"DARKFLAT_{name} = {first['input']!r}: {first['msg']}; correct or unset it"
            raise InputError(msg, code="bad-setting") from error

    @property
    def host_names(self) -> frozenset[str]:
        """Those of `hosts`, and `host` itself, as a `Host` header has them: without a port."""
        given = {each.strip().lower() for each in (*self.hosts.split(","), self.host)}
        return frozenset(f"[{each}]" if ":" in each else each for each in given - _NO_NAMES)

    @property
    def url(self) -> str:
        """The store's URL."""
        return self.store_url or f"sqlite:///{self.home / 'store.sqlite3'}"

    @property
    def sets_folder(self) -> Path:
        """Of the content-addressed coefficient sets, `<sha256>.h5`."""
        return self.home / "coefficient-sets"

    @property
    def recordings_folder(self) -> Path:
        """Of the recordings that were uploaded, one folder per digest."""
        return self.home / "recordings"

    @property
    def runs_folder(self) -> Path:
        """Of what runs record, one file per run."""
        return self.home / "runs"

    @property
    def jobs_folder(self) -> Path:
        """Of what jobs leave for their clients, one folder per job."""
        return self.home / "jobs"

    @property
    def work_folder(self) -> Path:
        """Of what is under way; on the same file system as what it becomes."""
        return self.home / "work"
