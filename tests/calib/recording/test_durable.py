"""Writing whole or not at all."""

import errno

import pytest

from calib.errors import DarkflatError
from calib.recording import durable
from calib.recording.durable import DiskFullError, write_whole


def test_a_file_is_written_and_written_over_whole(tmp_path):
    path = tmp_path / "any.csv"
    for content in (b"first, and longer", b"second"):
        write_whole(path, content)
        assert path.read_bytes() == content
    assert [each.name for each in tmp_path.iterdir()] == ["any.csv"]


def test_a_full_disk_leaves_what_was_there(tmp_path, monkeypatch):
    path = tmp_path / "any.csv"
    write_whole(path, b"before")

    def full(_path):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(durable, "sync", full)
    with pytest.raises(DiskFullError):
        write_whole(path, b"after")
    assert path.read_bytes() == b"before"
    assert [each.name for each in tmp_path.iterdir()] == ["any.csv"]


def test_a_folder_that_is_not_there_is_named(tmp_path):
    with pytest.raises(DarkflatError, match="nowhere") as error:
        write_whole(tmp_path / "nowhere" / "any.csv", b"")
    assert error.value.code == "cannot-write"
