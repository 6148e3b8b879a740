"""Recordings cut or altered at any byte: read as they were, or one sentence; never a hang.

HDF5 has answers of its own for damage: errors of any class, and, as a SWMR reader, waiting for
ever. The files here are closed properly, or abandoned by a writer that was killed.
"""

import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from calib.errors import InputError
from calib.recording.open import open_recording
from calib.recording.writer import RecordingWriter
from tests.calib.recording.examples import codes, write_recording

N_CUTS, N_ALTERED = 60, 150
SUPERBLOCK = range(0, 48, 3)


def abandoned(path: Path) -> Path:
    ran = subprocess.run(
        [sys.executable, "-m", "tests.test_bad_input.dying_writer", path], check=False
    )
    assert ran.returncode == -signal.SIGKILL
    return path


@pytest.fixture(scope="module", params=[write_recording, abandoned], ids=["closed", "abandoned"])
def whole(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path: Path = request.param(tmp_path_factory.mktemp("whole") / "a.h5")
    assert read(path) is None
    return path


def read(path: Path) -> str | None:
    """Return the code of the error; None where every line came as it was recorded."""
    try:
        recording = open_recording(path)
        assert len(recording.header.blocks) == 3
        for block in recording.header.blocks:
            dn = np.concatenate(list(recording.frames(block.block)))
            assert np.array_equal(dn, codes(block.block, 20))
    except InputError as error:
        return error.code
    return None


def beside(whole: Path, folder: Path, content: bytes) -> Path:
    path = folder / "a.h5"
    path.write_bytes(content)
    path.with_suffix(".frames.jsonl").write_bytes(whole.with_suffix(".frames.jsonl").read_bytes())
    return path


def end_of_frames(content: bytes) -> int:
    """Return where the last of the frames ends; what follows is room that was not used."""
    last = codes("002", 20)[16:].tobytes()
    return content.index(last) + len(last)


def test_a_file_cut_anywhere_is_refused(whole: Path, tmp_path: Path) -> None:
    content = whole.read_bytes()
    cuts = {*SUPERBLOCK, *map(int, np.linspace(48, end_of_frames(content) - 1, N_CUTS))}
    for n_bytes in cuts:
        assert read(beside(whole, tmp_path, content[:n_bytes])) is not None, n_bytes


def test_an_altered_byte_is_found_or_is_of_no_consequence(whole: Path, tmp_path: Path) -> None:
    content = whole.read_bytes()
    rng = np.random.default_rng(20)
    refused = set()
    for at in (*SUPERBLOCK, *map(int, rng.integers(48, end_of_frames(content), N_ALTERED))):
        altered = bytearray(content)
        altered[at] ^= 0xFF
        refused.add(read(beside(whole, tmp_path, bytes(altered))))
    assert {"recording-unreadable", "crc-mismatch"} <= refused


def test_damage_is_refused_by_resume_too(whole: Path, tmp_path: Path) -> None:
    content = whole.read_bytes()
    for at in SUPERBLOCK:
        altered = bytearray(content)
        altered[at] ^= 0xFF
        path = beside(whole, tmp_path, bytes(altered))
        with pytest.raises(InputError):
            RecordingWriter.resume(path)
        assert path.read_bytes() == bytes(altered)
