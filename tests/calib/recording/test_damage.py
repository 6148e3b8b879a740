"""Recordings that something happened to after they were made."""

import json
import struct
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest

from calib.errors import InputError
from calib.recording.file_recording import FileRecording
from calib.recording.open import open_recording
from calib.recording.salvage import reopen
from calib.recording.superblock import lookup3, mark_as_closed
from calib.recording.writer import RecordingWriter
from tests.calib.recording.examples import HEADER, blocks, codes, record, write_recording


def read_all(path: Path) -> None:
    recording = open_recording(path)
    for block in recording.header.blocks:
        for _ in recording.frames(block.block):
            pass


def lose_commit_record(path: Path) -> None:
    path.with_suffix(".frames.jsonl").unlink()


def change_a_code(path: Path) -> None:
    with h5py.File(path, "r+", locking=False) as file:
        file["frames"][4, 1, 1] ^= 1


def cut_in_half(path: Path) -> None:
    content = path.read_bytes()
    path.write_bytes(content[: len(content) // 2])


def empty(path: Path) -> None:
    path.write_bytes(b"")


def other_hdf5(path: Path) -> None:
    with h5py.File(path, "w") as file:
        file["images"] = [1, 2, 3]


def other_commit_record(path: Path) -> None:
    write_recording(path.with_name("b.h5"))
    path.with_name("b.frames.jsonl").rename(path.with_suffix(".frames.jsonl"))


def garble_a_middle_line(path: Path) -> None:
    record_path = path.with_suffix(".frames.jsonl")
    lines = record_path.read_text().splitlines(keepends=True)
    record_path.write_text("".join([*lines[:3], "x" + lines[3], *lines[4:]]))


def drop_line(number: int, path: Path) -> None:
    record_path = path.with_suffix(".frames.jsonl")
    lines = record_path.read_text().splitlines(keepends=True)
    record_path.write_text("".join([*lines[:number], *lines[number + 1 :]]))


def drop_the_first_line(path: Path) -> None:
    drop_line(0, path)


def drop_a_begin(path: Path) -> None:
    drop_line(1, path)


def drop_a_frame(path: Path) -> None:
    drop_line(3, path)


def drop_an_end(path: Path) -> None:
    drop_line(5, path)


DAMAGES: list[tuple[Callable[[Path], None], str, str]] = [
    (lose_commit_record, "commit-record-missing", "a.frames.jsonl is missing"),
    (change_a_code, "crc-mismatch", "frame 4 of block 001"),
    (cut_in_half, "recording-truncated", "truncated"),
    (empty, "recording-unreadable", "restore it from a copy"),
    (other_hdf5, "not-a-recording", "no recording of darkflat"),
    (other_commit_record, "commit-record-mismatch", "different recordings"),
    (garble_a_middle_line, "commit-record-damaged", "line 4"),
    (drop_the_first_line, "commit-record-damaged", "does not begin"),
    (drop_a_begin, "commit-record-damaged", "outside its block"),
    (drop_a_frame, "commit-record-damaged", "frame 2 where 1 comes next"),
    (drop_an_end, "commit-record-damaged", "before it ended"),
]


@pytest.mark.parametrize(
    ("damage", "code", "words"), DAMAGES, ids=[each[0].__name__ for each in DAMAGES]
)
def test_damage_is_named_and_nothing_is_changed(
    tmp_path: Path, damage: Callable[[Path], None], code: str, words: str
) -> None:
    path = write_recording(tmp_path / "a.h5")
    damage(path)
    before = {each: each.read_bytes() for each in tmp_path.iterdir()}
    for use in (read_all, reopen):
        with pytest.raises(InputError, match=words) as refused:
            use(path)
        assert refused.value.code == code
        assert "\n" not in str(refused.value)
    assert {each: each.read_bytes() for each in tmp_path.iterdir()} == before


def test_a_torn_last_line_is_dropped_with_its_frame(tmp_path: Path) -> None:
    path = tmp_path / "a.h5"
    with RecordingWriter.create(path, HEADER, 8) as writer:
        record(writer, blocks()[0], codes("000", 20))
        record(writer, blocks()[1], codes("001", 16), end=False)
    record_path = path.with_suffix(".frames.jsonl")
    record_path.write_bytes(record_path.read_bytes()[:-9])
    torn = FileRecording(path)
    assert any("torn" in warning for warning in torn.warnings)
    assert any("without a commit line" in warning for warning in torn.warnings)
    assert torn.commits.n_frames == 4
    with RecordingWriter.resume(path) as writer:
        assert writer.whole_blocks == ("000",)
        record(writer, blocks()[1], codes("001", 20))
    resumed = FileRecording(path)
    assert np.array_equal(np.concatenate(list(resumed.frames("001"))), codes("001", 20))
    assert [frame.index for frame in resumed.commits.superseded] == [3]
    assert [frame.index for frame in resumed.commits.whole[1].frames] == [4, 5, 6]
    for line in record_path.read_text().splitlines():
        json.loads(line)


def test_an_unfinished_block_is_left_out_with_a_warning(tmp_path: Path) -> None:
    with RecordingWriter.create(tmp_path / "a.h5", HEADER, 8) as writer:
        record(writer, blocks()[0], codes("000", 16), end=False)
    recording = FileRecording(tmp_path / "a.h5")
    assert recording.header.blocks == ()
    assert any("block 000 is unfinished" in warning for warning in recording.warnings)
    with pytest.raises(InputError, match="no whole block 000"):
        next(recording.frames("000"))


@pytest.mark.parametrize("name", ["a.h5", "nowhere/a.h5"])
def test_what_is_not_there_is_said_to_be_missing(tmp_path: Path, name: str) -> None:
    for use in (open_recording, RecordingWriter.resume):
        with pytest.raises(InputError) as refused:
            use(tmp_path / name)
        assert refused.value.code == "recording-not-found"


def test_a_commit_record_is_not_opened_in_place_of_its_recording(tmp_path: Path) -> None:
    write_recording(tmp_path / "a.h5")
    with pytest.raises(InputError, match=r"name the \.h5 file"):
        open_recording(tmp_path / "a.frames.jsonl")


def test_the_checksum_is_the_one_that_hdf5_writes(tmp_path: Path) -> None:
    for n in range(6):
        path = tmp_path / f"{n}.h5"
        with h5py.File(path, "w", libver="latest") as file:
            file["x"] = np.arange(37 * n)
        block = path.read_bytes()[:48]
        assert lookup3(block[:44]) == struct.unpack("<I", block[44:])[0]


def test_a_file_that_was_closed_is_left_as_it_is(tmp_path: Path) -> None:
    path = write_recording(tmp_path / "a.h5")
    before = path.read_bytes()
    assert mark_as_closed(path, reserve_bytes=100) is False
    assert path.read_bytes() == before


def test_a_closed_file_is_no_longer_than_it_needs(tmp_path: Path) -> None:
    path = write_recording(tmp_path / "a.h5")
    assert path.stat().st_size < 60 * 48 * 2 + 20_000
