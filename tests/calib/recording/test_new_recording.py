"""A recording that is written whole: what a kill leaves must not refuse the next attempt."""

from pathlib import Path

import pytest

from calib.errors import InputError
from calib.recording.commit_log import commit_path
from calib.recording.new_recording import new_recording


class KilledError(BaseException):
    """Stands for the process's end: nothing after it is done."""


def write(out: Path, content: str) -> None:
    with new_recording(out) as partial:
        partial.write_text(content)
        commit_path(partial).write_text(content)


def kill_between_the_renames(out: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    rename = Path.rename
    gone: list[Path] = []

    def until_killed(path: Path, to: Path) -> Path:
        if gone:
            raise KilledError
        gone.append(path)
        return rename(path, to)

    with monkeypatch.context() as patched:
        patched.setattr(Path, "rename", until_killed)
        patched.setattr(Path, "unlink", lambda *_, **__: None)
        with pytest.raises(KilledError):
            write(out, "first")


def test_what_a_kill_between_the_renames_leaves_is_replaced(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out = tmp_path / "rec.h5"
    kill_between_the_renames(out, monkeypatch)
    assert commit_path(out).exists()
    assert not out.exists()
    write(out, "second")
    assert (out.read_text(), commit_path(out).read_text()) == ("second", "second")
    assert set(tmp_path.iterdir()) == {out, commit_path(out)}


def test_the_record_of_a_file_that_was_moved_away_is_kept(tmp_path: Path) -> None:
    out = tmp_path / "rec.h5"
    write(out, "first")
    out.unlink()
    with pytest.raises(InputError, match="exists already") as caught:
        write(out, "second")
    assert caught.value.code == "output-exists"
    assert commit_path(out).read_text() == "first"
