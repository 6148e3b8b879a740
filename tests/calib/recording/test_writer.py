import json
from pathlib import Path

import numpy as np
import pytest

from calib.errors import DarkflatError, InputError
from calib.recording.file_recording import FileRecording
from calib.recording.frame_record import FrameRecord
from calib.recording.header import CameraHeader, RecordingHeader
from calib.recording.open import open_recording
from calib.recording.writer import RecordingWriter
from tests.calib.recording.examples import HEADER, blocks, codes, record, write_recording


def test_what_was_appended_is_read_back_exactly(tmp_path: Path) -> None:
    recording = open_recording(write_recording(tmp_path / "a.h5"))
    assert recording.header.blocks == blocks()
    assert recording.header.camera == HEADER.camera
    for block in blocks():
        frames = list(recording.frames(block.block))
        assert [len(dn) for dn in frames] == [8, 8, 4]
        assert np.array_equal(np.concatenate(frames), codes(block.block, 20))
    assert recording.warnings == ()


def test_the_commit_record_keeps_every_read_back(tmp_path: Path) -> None:
    record_of_frame = FrameRecord(
        frame_id=7,
        device_timestamp_ns=1,
        host_timestamp_ns=2,
        exposure_us=99.9,
        gain_db=1.5,
        level=3.0,
        lamp_currents_a=(6.1, 6.2),
        monitor_a=1e-7,
        sensor_temperature_c=31.5,
    )
    with RecordingWriter.create(tmp_path / "a.h5", HEADER, 8) as writer:
        writer.begin_block(blocks()[0])
        writer.append(codes("000", 8), record_of_frame)
        writer.lost("000", "packet 3 missing", frame_id=8)
        writer.note("lamp 2 flickers")
    commits = FileRecording(tmp_path / "a.h5").commits
    assert commits.unfinished is not None
    assert commits.unfinished.frames[0].record == record_of_frame
    assert (commits.lost[0].reason, commits.lost[0].frame_id) == ("packet 3 missing", 8)
    assert commits.notes == ("lamp 2 flickers",)


def test_headers_plan_features_and_scenes_are_kept(tmp_path: Path) -> None:
    scene = np.linspace(0.0, 1.0, 48 * 3).reshape(3, 48)
    with RecordingWriter.create(
        tmp_path / "a.h5", HEADER, 8, plan="x = 1", features={"Gain": "1"}, scenes={"land": scene}
    ):
        pass
    before = FileRecording(tmp_path / "a.h5").provenance
    assert (before.plan, before.features) == ("x = 1", {"Gain": "1"})
    assert np.array_equal(before.scenes["land"], scene)


def test_a_live_recording_can_be_read(tmp_path: Path) -> None:
    with RecordingWriter.create(tmp_path / "a.h5", HEADER, 8) as writer:
        record(writer, blocks()[0], codes("000", 20))
        writer.begin_block(blocks()[1])
        writer.append(codes("001", 8))
        live = FileRecording(tmp_path / "a.h5")
        assert np.array_equal(np.concatenate(list(live.frames("000"))), codes("000", 20))
        assert live.commits.unfinished is not None
        assert live.commits.unfinished.lines == 8
        writer.append(codes("001", 8))  # the reader does not disturb the writer


@pytest.mark.parametrize("bit_depth", [8, 10, 16])
def test_area_frames_keep_their_shape(tmp_path: Path, bit_depth: int) -> None:
    camera = CameraHeader(columns=6, rows=4, bit_depth=bit_depth)
    header = RecordingHeader(camera=camera)
    dn = codes("000", 5, camera)
    with RecordingWriter.create(tmp_path / "a.h5", header, 1) as writer:
        writer.begin_block(blocks(1, lines=5)[0])
        for frame in dn:
            writer.append(frame)
        writer.end_block(blocks(1, lines=5)[0])
    read = np.concatenate(list(open_recording(tmp_path / "a.h5").frames("000")))
    assert np.array_equal(read, dn)
    assert read.dtype == dn.dtype


@pytest.mark.parametrize(
    ("dn", "code"),
    [
        (np.zeros((8, 47), np.uint16), "frames-wrong-shape"),
        (np.zeros((9, 48), np.uint16), "frames-wrong-shape"),
        (np.zeros((0, 48), np.uint16), "frames-wrong-shape"),
        (np.zeros((8, 48), np.float32), "frames-wrong-dtype"),
        (np.zeros((8, 48), np.int16), "frames-wrong-dtype"),
        (np.zeros((8, 48), np.uint8), "frames-wrong-dtype"),
        (np.full((8, 48), 4096, np.uint16), "code-above-full-scale"),
    ],
)
def test_frames_that_no_such_camera_sends_are_refused(
    tmp_path: Path, dn: object, code: str
) -> None:
    with RecordingWriter.create(tmp_path / "a.h5", HEADER, 8) as writer:
        writer.begin_block(blocks()[0])
        with pytest.raises(InputError) as refused:
            writer.append(dn)  # type: ignore[arg-type]
        assert refused.value.code == code
        writer.append(codes("000", 8))  # and nothing is lost by it


def test_blocks_out_of_order_of_call_or_time_are_refused(tmp_path: Path) -> None:
    first, second, third = blocks()
    with RecordingWriter.create(tmp_path / "a.h5", HEADER, 8) as writer:
        with pytest.raises(DarkflatError, match="begin one first"):
            writer.append(codes("000", 8))
        record(writer, second, codes("001", 20))
        for block, code in ((second, "duplicate-block"), (first, "conditions-out-of-order")):
            with pytest.raises(InputError) as refused:
                writer.begin_block(block)
            assert refused.value.code == code
        writer.begin_block(third)
        writer.append(codes("002", 8))
        with pytest.raises(InputError, match="8 lines, but its conditions say 20"):
            writer.end_block(third)
        writer.discard_block("too few lines")
        record(writer, third, codes("002", 20))
    recording = FileRecording(tmp_path / "a.h5")
    assert [block.block for block in recording.header.blocks] == ["001", "002"]
    assert np.array_equal(np.concatenate(list(recording.frames("002"))), codes("002", 20))


def test_an_existing_recording_is_never_overwritten(tmp_path: Path) -> None:
    path = write_recording(tmp_path / "a.h5")
    before = path.read_bytes()
    with pytest.raises(InputError) as refused:
        RecordingWriter.create(path, HEADER, 8)
    assert refused.value.code == "output-exists"
    assert path.read_bytes() == before
    path.unlink()
    with pytest.raises(InputError, match="without"):
        RecordingWriter.create(path, HEADER, 8)


def test_a_second_writer_is_refused(tmp_path: Path) -> None:
    with RecordingWriter.create(tmp_path / "a.h5", HEADER, 8):
        with pytest.raises(InputError) as refused:
            RecordingWriter.resume(tmp_path / "a.h5")
        assert refused.value.code == "recording-in-use"


def test_a_start_that_fails_leaves_nothing(tmp_path: Path) -> None:
    with pytest.raises(InputError) as refused:
        RecordingWriter.create(tmp_path / "a.h5", HEADER, 1 << 30)
    assert refused.value.code == "frame-size-invalid"
    assert list(tmp_path.iterdir()) == []


def test_lines_of_the_commit_record_are_json(tmp_path: Path) -> None:
    write_recording(tmp_path / "a.h5")
    lines = (tmp_path / "a.frames.jsonl").read_text().splitlines()
    kinds = [json.loads(line)["kind"] for line in lines]
    assert kinds == ["recording", *(["begin", *["frame"] * 3, "end"] * 3)]
