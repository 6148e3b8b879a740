"""Running `darkflat` on a copy of the sound files, and seeing what it left."""

import json
import shutil
import tempfile
from contextlib import chdir
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from service.cli.app import app
from tests.service.cli.answers import without_progress
from tests.test_bad_input.case import Case

Tree = dict[str, bytes | None]
"""Every file's content by its path; None for a folder."""


@dataclass(frozen=True)
class Refused:
    """What a command said, and every file before and after it."""

    status: int
    stdout: str
    stderr: str
    before: Tree
    after: Tree

    @property
    def error(self) -> dict[str, Any]:
        """`code` and `message` of the JSON answer."""
        answer: dict[str, Any] = json.loads(self.stdout)
        assert set(answer) == {"error"}
        error: dict[str, Any] = answer["error"]
        return error


def tree(folder: Path) -> Tree:
    """Return all that is in `folder`, hidden files too, but for the store's database."""
    return {
        str(path.relative_to(folder)): path.read_bytes() if path.is_file() else None
        for path in sorted(folder.rglob("*"))
        if not path.name.startswith("store.sqlite3")
    }


def run(case: Case, sound: Path, folder: Path) -> Refused:
    """Do the case's damage to a copy of the sound files in `folder`, and run its command there.

    The home of the store and the temporary files are folders beside, which are looked at too.
    """
    work = folder / "work"
    shutil.copytree(sound, work)
    case.damage(work)
    with pytest.MonkeyPatch.context() as patch:
        for name, variable in (("home", "DARKFLAT_HOME"), ("temporary", "TMPDIR")):
            (folder / name).mkdir(exist_ok=True)
            patch.setenv(variable, str(folder / name))
        patch.setattr(tempfile, "tempdir", None)
        patch.delenv("DARKFLAT_BENCH", raising=False)
        without_progress(patch)
        before = tree(folder)
        with chdir(work):
            ran = CliRunner().invoke(app, [*case.arguments, "--json", "-"])
    return Refused(ran.exit_code, ran.stdout, ran.stderr, before, tree(folder))
