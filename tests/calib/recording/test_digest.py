from pathlib import Path

import pytest

from calib.errors import InputError
from calib.recording.digest import DigestedWhileRead
from calib.recording.open import open_recording
from calib.recording.protocol import Recording
from calib.recording.statistics import column_statistics
from tests.calib.recording.examples import write_recording

NAMES = ("000", "001", "002")


class Counting:
    """A recording that counts how often its blocks are read."""

    def __init__(self, recording: Recording) -> None:
        self._recording = recording
        self.path, self.header, self.warnings = recording.path, recording.header, ()
        self.n_read = 0

    def frames(self, block: str):
        self.n_read += 1
        return self._recording.frames(block)

    def digest(self) -> str:
        self.n_read += len(self.header.blocks)
        return self._recording.digest()


@pytest.fixture
def counting(tmp_path: Path) -> Counting:
    return Counting(open_recording(write_recording(tmp_path / "a.h5")))


def read(recording: Recording, *names: str) -> None:
    for name in names:
        for _ in recording.frames(name):
            pass


def test_one_pass_for_the_statistics_gives_the_digest_too(counting: Counting) -> None:
    alongside = DigestedWhileRead(counting)
    column_statistics(alongside)
    got = alongside.digest()
    assert counting.n_read == len(NAMES)
    assert got == counting.digest()


@pytest.mark.parametrize(
    "order",
    [(), NAMES[:2], NAMES[::-1], (*NAMES, "001"), ("000", "000", "001", "002"), NAMES[1:]],
)
def test_the_digest_is_the_same_whatever_was_read_before(
    counting: Counting, order: tuple[str, ...]
) -> None:
    alongside = DigestedWhileRead(counting)
    read(alongside, *order)
    assert alongside.digest() == counting.digest()


def test_a_block_that_was_not_read_to_its_end_does_not_spoil_the_digest(counting: Counting) -> None:
    alongside = DigestedWhileRead(counting)
    stopped = alongside.frames("000")
    next(iter(stopped))
    stopped.close()
    read(alongside, *NAMES)
    assert alongside.digest() == counting.digest()


def test_blocks_read_side_by_side_do_not_spoil_the_digest(counting: Counting) -> None:
    alongside = DigestedWhileRead(counting)
    for _ in zip(*(alongside.frames(name) for name in NAMES), strict=True):
        pass
    assert alongside.digest() == counting.digest()


def test_a_damaged_frame_is_refused_as_ever(tmp_path: Path) -> None:
    path = write_recording(tmp_path / "a.h5")
    content = bytearray(path.read_bytes())
    frame = next(open_recording(path).frames("001"))[:8].tobytes()
    content[content.index(frame)] ^= 1
    path.write_bytes(content)
    with pytest.raises(InputError) as error:
        column_statistics(DigestedWhileRead(open_recording(path)))
    assert error.value.code == "crc-mismatch"
