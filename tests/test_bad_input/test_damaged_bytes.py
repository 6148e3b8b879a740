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
from calib.radiometric.coefficients.coefficient_set import CoefficientSet
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


def altered_at(content: bytes, at: int) -> bytes:
    """Return `content` with the bits of one byte flipped."""
    return content[:at] + bytes([content[at] ^ 0xFF]) + content[at + 1 :]


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
    rng = np.random.default_rng(23)
    refused = set()
    for at in (*SUPERBLOCK, *map(int, rng.integers(48, end_of_frames(content), N_ALTERED))):
        refused.add(read(beside(whole, tmp_path, altered_at(content, at))))
    assert {"recording-unreadable", "crc-mismatch"} <= refused


def test_damage_is_refused_by_resume_too(whole: Path, tmp_path: Path) -> None:
    content = whole.read_bytes()
    for at in SUPERBLOCK:
        altered = altered_at(content, at)
        path = beside(whole, tmp_path, altered)
        with pytest.raises(InputError):
            RecordingWriter.resume(path)
        assert path.read_bytes() == altered


def test_a_coefficient_set_cut_or_altered_anywhere_is_refused_or_the_same(
    sound: Path, tmp_path: Path
) -> None:
    content = (sound / "set.h5").read_bytes()
    whole = CoefficientSet.load(sound / "set.h5").id
    path, refused = tmp_path / "set.h5", set()
    rng = np.random.default_rng(23)
    cuts = [content[:n] for n in map(int, np.linspace(0, len(content) - 1, N_CUTS))]
    for each in cuts + [altered_at(content, at) for at in rng.integers(0, len(content), N_ALTERED)]:
        path.write_bytes(each)
        try:
            assert CoefficientSet.load(path).id == whole
        except InputError as error:
            refused.add(error.code)
    assert refused == {"altered", "not-a-coefficient-set"}
