import tracemalloc
from collections.abc import Iterator
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path

import h5py
import numpy as np
import pytest
from numpy.random import default_rng

from calib.errors import DarkflatError, InputError
from calib.radiometric.correction.apply import Correction
from calib.radiometric.correction.apply_checks import Validity
from calib.radiometric.correction.apply_options import ApplyOptions
from calib.radiometric.correction.apply_recording import CancelledError, correct_recording
from calib.radiometric.correction.transmittance import DESTINY_NIR
from calib.recording.header import Block, RecordingHeader
from tests.calib.radiometric.example_set import example_set

SET = example_set()
STARTED = datetime(2026, 11, 22, 9, 30, tzinfo=UTC)
CAMERA = SET.camera.model_copy(update={"started_at": STARTED})
BLOCKS = (
    Block(block="a", kind="flat", exposure_us=200.0, started_s=0.0),
    Block(block="b", kind="scene", exposure_us=900.0, started_s=60.0),
)


@dataclass(frozen=True)
class MemoryRecording:
    """Draws its frames afresh, so that none is kept."""

    header: RecordingHeader = field(
        default_factory=lambda: RecordingHeader(camera=CAMERA, blocks=BLOCKS)
    )
    n_frames: int = 2
    frame_lines: int = 5
    path: Path = Path("rec.h5")
    warnings: tuple[str, ...] = ()

    def frames(self, block: str) -> Iterator[np.ndarray]:
        rng = default_rng(ord(block))
        shape = (self.frame_lines, self.header.camera.columns)
        for _ in range(self.n_frames):
            yield rng.integers(0, 4096, shape, dtype=np.uint16)

    def digest(self) -> str:
        return "0" * 64


def test_each_block_is_corrected_with_its_own_exposure(tmp_path):
    recording = MemoryRecording()
    correct_recording(recording, SET, tmp_path / "out.h5")
    with h5py.File(tmp_path / "out.h5") as file:
        assert list(file["blocks"]) == ["a", "b"]
        for block in BLOCKS:
            dn = np.concatenate(list(recording.frames(block.block)))
            expected = Correction(SET, block.exposure_us, camera=CAMERA).lines(dn)
            group = file["blocks"][block.block]
            for name in ("radiance", "std", "flags"):
                np.testing.assert_array_equal(group[name][:], getattr(expected, name))


def test_the_output_says_what_it_was_made_with(tmp_path):
    options = ApplyOptions(window=DESTINY_NIR)
    done = correct_recording(MemoryRecording(), SET, tmp_path / "out.h5", options=options)
    assert done.coefficient_set == SET.id
    assert done.n_lines == 20
    assert done.flags["masked"] == 20
    assert len(done.notes) == 1
    assert "(blocks b)" in done.notes[0]
    with h5py.File(tmp_path / "out.h5") as file:
        assert file.attrs["coefficient_set"] == SET.id
        assert file.attrs["radiance_unit"] == "W m-2 sr-1"
        assert file.attrs["window_transmittance"] == DESTINY_NIR.transmittance
        assert file.attrs["flag_masked"] == 4
        assert "900" in file["blocks/b"].attrs["notes"]


def test_the_files_columns_give_the_uncertainty_of_a_mean_back(tmp_path):
    recording = MemoryRecording(n_frames=1)
    correct_recording(recording, SET, tmp_path / "out.h5")
    (dn,) = recording.frames("a")
    mean = Correction(SET, 200.0, camera=CAMERA).mean_line(np.clip(dn, 100, 3000))
    with h5py.File(tmp_path / "out.h5") as file:
        columns = {name: values[:] for name, values in file["columns/200"].items()}
        signal = np.clip(dn, 100, 3000).mean(axis=0) - columns["dark_dn"]
        temporal = columns["noise_dn2"] + file.attrs["system_gain_dn_per_e"] * signal
        variance = columns["v0"] + signal * (columns["v1"] + columns["v2"] * signal)
        std = np.sqrt(temporal / len(dn) + variance) * columns["scale"]
    np.testing.assert_allclose(mean.std[0], std, rtol=1e-6)


DARK = Block(block="k", kind="dark", exposure_us=200.0)
WITH_DARK = RecordingHeader(camera=CAMERA, blocks=(*BLOCKS, DARK))


def test_capped_darks_are_left_out_of_file_and_counts_and_named(tmp_path):
    done = correct_recording(MemoryRecording(WITH_DARK), SET, tmp_path / "out.h5")
    without = correct_recording(MemoryRecording(), SET, tmp_path / "without.h5")
    assert (done.blocks, done.left_out) == (("a", "b"), ("k",))
    assert (done.flags, done.n_lines) == (without.flags, without.n_lines)
    with h5py.File(tmp_path / "out.h5") as file:
        assert list(file["blocks"]) == ["a", "b"]


def test_a_capped_dark_is_corrected_where_it_is_asked_for(tmp_path):
    options = ApplyOptions(blocks=["k"])
    recording = MemoryRecording(WITH_DARK)
    done = correct_recording(recording, SET, tmp_path / "out.h5", options=options)
    assert (done.blocks, done.left_out) == (("k",), ())


def test_without_uncertainty_there_is_no_such_dataset(tmp_path):
    options = ApplyOptions(std=False, blocks=["b"])
    done = correct_recording(MemoryRecording(), SET, tmp_path / "out.h5", options=options)
    assert done.blocks == ("b",)
    with h5py.File(tmp_path / "out.h5") as file:
        assert sorted(file["blocks/b"]) == ["flags", "radiance"]


def test_progress_ends_at_one(tmp_path):
    shares = []
    correct_recording(MemoryRecording(), SET, tmp_path / "out.h5", progress=shares.append)
    assert shares == [0.5, 1.0]


def test_cancelling_leaves_nothing_behind(tmp_path):
    answers = iter([False, False, True])
    with pytest.raises(CancelledError):
        correct_recording(
            MemoryRecording(), SET, tmp_path / "out.h5", cancelled=lambda: next(answers)
        )
    assert list(tmp_path.iterdir()) == []


class BrokenRecording(MemoryRecording):
    def frames(self, block: str) -> Iterator[np.ndarray]:
        yield from super().frames(block)
        raise InputError("the tail is damaged", code="damaged")


def test_a_recording_that_breaks_leaves_nothing_behind(tmp_path):
    with pytest.raises(InputError, match="tail"):
        correct_recording(BrokenRecording(), SET, tmp_path / "out.h5")
    assert list(tmp_path.iterdir()) == []


AREA = RecordingHeader(camera=CAMERA.model_copy(update={"rows": 4}), blocks=BLOCKS)
OTHER = RecordingHeader(camera=CAMERA.model_copy(update={"serial": "B0002"}), blocks=BLOCKS)
UNTIL = Validity(valid_until=datetime(2026, 11, 22, 9, 30, 30, tzinfo=UTC))


@pytest.mark.parametrize(
    ("recording", "options", "code"),
    [
        (MemoryRecording(AREA), ApplyOptions(), "area-sensor"),
        (MemoryRecording(OTHER), ApplyOptions(), "set-mismatch"),
        (MemoryRecording(), ApplyOptions(validity=UNTIL), "outside-validity"),
        (MemoryRecording(), ApplyOptions(blocks=["c"]), "no-such-block"),
        (
            MemoryRecording(RecordingHeader(camera=CAMERA, blocks=(DARK,))),
            ApplyOptions(),
            "only-darks",
        ),
        (MemoryRecording(RecordingHeader(camera=CAMERA)), ApplyOptions(), "no-such-block"),
    ],
)
def test_what_cannot_be_corrected_is_refused_before_anything_is_written(
    tmp_path, recording, options, code
):
    with pytest.raises(InputError) as error:
        correct_recording(recording, SET, tmp_path / "out.h5", options=options)
    assert error.value.code == code
    assert list(tmp_path.iterdir()) == []


def test_a_block_within_the_validity_is_corrected(tmp_path):
    options = ApplyOptions(validity=UNTIL, blocks=["a"])
    done = correct_recording(MemoryRecording(), SET, tmp_path / "out.h5", options=options)
    assert done.flags["outside_validity"] == 0


def test_an_existing_output_is_kept(tmp_path):
    (tmp_path / "out.h5").write_text("mine")
    with pytest.raises(DarkflatError) as error:
        correct_recording(MemoryRecording(), SET, tmp_path / "out.h5")
    assert error.value.code == "output-exists"
    assert (tmp_path / "out.h5").read_text() == "mine"


def test_memory_does_not_grow_with_the_recording(tmp_path):
    peaks = []
    for n_frames in (4, 40):
        recording = MemoryRecording(n_frames=n_frames, frame_lines=400)
        tracemalloc.start()
        correct_recording(recording, SET, tmp_path / f"{n_frames}.h5")
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    assert peaks[1] < 1.5 * peaks[0]
