import os
import tomllib
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest
import tifffile
from astropy.io import fits

from calib.errors import DarkflatError, InputError, NotDeterminedError
from calib.recording.folder import FrameFormatName, export_folder, import_folder
from calib.recording.folder_recording import FolderRecording
from calib.recording.header import Block, CameraHeader, RecordingHeader
from calib.recording.open import open_recording
from calib.recording.statistics import column_statistics
from tests.calib.recording.examples import HEADER, blocks, codes, write_recording

FORMATS: tuple[FrameFormatName, ...] = ("npy", "tif", "fits", "raw")
CAMERAS = {
    "8 bit": CameraHeader(columns=31, bit_depth=8),
    "12 bit": HEADER.camera,
    "16 bit": CameraHeader(columns=5, bit_depth=16),
    "area": CameraHeader(columns=7, rows=5, bit_depth=12),
    "area of three columns": CameraHeader(columns=3, rows=4, bit_depth=8),
}


@pytest.mark.parametrize("frame_format", FORMATS)
@pytest.mark.parametrize("camera", CAMERAS.values(), ids=CAMERAS)
def test_export_and_import_are_exact(
    tmp_path: Path, camera: CameraHeader, frame_format: FrameFormatName
) -> None:
    header = RecordingHeader(camera=camera)
    recording = open_recording(write_recording(tmp_path / "a.h5", header))
    folder = export_folder(recording, tmp_path / "out", frame_format=frame_format)
    for block in blocks():
        read = np.concatenate(list(folder.frames(block.block)))
        assert np.array_equal(read, codes(block.block, 20, camera))
        assert read.dtype == codes(block.block, 20, camera).dtype
    assert folder.header.blocks == recording.header.blocks
    back = import_folder(tmp_path / "out", tmp_path / "b.h5")
    assert back.header.blocks == recording.header.blocks
    assert recording.digest() == folder.digest() == back.digest()


@pytest.mark.parametrize("frame_format", FORMATS)
def test_one_area_frame_stays_a_stack_of_one(tmp_path: Path, frame_format: FrameFormatName) -> None:
    header = RecordingHeader(camera=CAMERAS["area"])
    path = write_recording(tmp_path / "a.h5", header, blocks(1, lines=1))
    folder = export_folder(open_recording(path), tmp_path / "out", frame_format=frame_format)
    assert next(folder.frames("000")).shape == (1, 5, 7)


UNKNOWN = {
    "text": "free, with a comma",
    "number as text": "3.50",
    "looks like a number": "3.5",
    "number": 2.25,
    "whole": 7,
    "flag": True,
    "empty text": "",
    "spaces": " x ",
    "quoted": '"q"',
    "unknown": None,
    "list": [1, 2],
}


def test_unknown_keys_and_empty_cells_come_through(tmp_path: Path) -> None:
    header = RecordingHeader.model_validate(
        {
            "camera": {"columns": 48, "bit_depth": 12, "lens": {"f_mm": 300.0}},
            "operator": {"name": "D. Olsen", "day": "2026-11-22"},
        }
    )
    wanted = tuple(
        Block.model_validate(
            {"block": f"b{k}", "kind": "flat", "exposure_us": 1 / (k + 3), **UNKNOWN}
        )
        for k in range(2)
    )
    recording = open_recording(write_recording(tmp_path / "a.h5", header, wanted))
    assert recording.header.blocks == wanted
    folder = export_folder(recording, tmp_path / "out")
    back = import_folder(tmp_path / "out", tmp_path / "b.h5")
    for each in (folder, back):
        assert each.header.blocks == wanted
        assert each.header.camera == header.camera
        assert each.header.model_extra == header.model_extra
        assert each.header.blocks[0].radiance is None
        assert each.header.blocks[0].lines is None
        assert sum("unknown" in warning for warning in each.warnings) >= 2
        assert each.digest() == recording.digest()


def test_another_code_or_condition_is_another_digest(tmp_path: Path) -> None:
    digests = {open_recording(write_recording(tmp_path / "a.h5")).digest()}
    for n, wanted in enumerate((blocks(2), blocks(3, lines=19), blocks()[1:])):
        digests.add(open_recording(write_recording(tmp_path / f"{n}.h5", HEADER, wanted)).digest())
    assert len(digests) == 4


def test_the_start_is_written_as_the_string_of_the_interchange_format(tmp_path: Path) -> None:
    camera = HEADER.camera.model_copy(
        update={"started_at": datetime(2026, 11, 22, 9, 30, tzinfo=UTC)}
    )
    header = RecordingHeader(camera=camera)
    recording = open_recording(write_recording(tmp_path / "a.h5", header))
    folder = export_folder(recording, tmp_path / "out")
    toml = folder.path / "recording.toml"
    written = toml.read_text()
    assert tomllib.loads(written)["camera"]["started_at"] == "2026-11-22T09:30:00Z"
    assert folder.header.camera == camera
    toml.write_text(written.replace('"2026-11-22T09:30:00Z"', "2026-11-22T09:30:00Z"))
    assert FolderRecording(folder.path).digest() == folder.digest() == recording.digest()


def test_a_plan_is_exported_as_toml_and_read_by_its_earlier_name_too(tmp_path: Path) -> None:
    folder = export_folder(open_recording(write_recording(tmp_path / "a.h5")), tmp_path / "out")
    (folder.path / "plan.txt").write_text("x = 1")
    again = export_folder(import_folder(folder.path, tmp_path / "b.h5"), tmp_path / "again")
    assert (again.path / "plan.toml").read_text() == "x = 1"
    assert not (again.path / "plan.txt").exists()


def test_provenance_and_scenes_travel_along(tmp_path: Path) -> None:
    folder = export_folder(open_recording(write_recording(tmp_path / "a.h5")), tmp_path / "out")
    (folder.path / "plan.toml").write_text("x = 1")
    (folder.path / "features.json").write_text('{"Gain": "1"}')
    text = (folder.path / "conditions.csv").read_text().splitlines()
    (folder.path / "conditions.csv").write_text(
        "\n".join([text[0] + ",scene", *(line + ",land" for line in text[1:])])
    )
    (folder.path / "scenes").mkdir()
    scene = np.linspace(0, 2, 48 * 20).reshape(20, 48)
    np.save(folder.path / "scenes/land.npy", scene)
    back = import_folder(folder.path, tmp_path / "b.h5")
    again = export_folder(back, tmp_path / "again")
    for each in (back, again):
        assert (each.provenance.plan, each.provenance.features) == ("x = 1", {"Gain": "1"})
        assert np.array_equal(each.scenes["land"], scene)


def test_compressed_and_other_tiffs_are_read(tmp_path: Path) -> None:
    header = RecordingHeader(camera=CAMERAS["area"])
    recording = open_recording(write_recording(tmp_path / "a.h5", header))
    folder = export_folder(recording, tmp_path / "out", frame_format="tif")
    for block in blocks():
        dn = codes(block.block, 20, header.camera)
        path = folder.path / "frames" / f"{block.block}.tif"
        tifffile.imwrite(path, dn, photometric="minisblack", compression="zlib", byteorder=">")
    assert FolderRecording(folder.path).digest() == recording.digest()


def test_signed_fits_of_short_codes_are_read_and_astropy_reads_ours(tmp_path: Path) -> None:
    recording = open_recording(write_recording(tmp_path / "a.h5"))
    folder = export_folder(recording, tmp_path / "out", frame_format="fits")
    path = folder.path / "frames/001.fits"
    assert np.array_equal(fits.getdata(path), codes("001", 20))
    fits.writeto(path, codes("001", 20).astype(np.int16), overwrite=True)
    assert FolderRecording(folder.path).digest() == recording.digest()
    fits.writeto(path, -1 - codes("001", 20).astype(np.int16), overwrite=True)
    with pytest.raises(InputError, match="negative"):
        FolderRecording(folder.path).digest()


def test_long_blocks_come_in_stretches(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = export_folder(open_recording(write_recording(tmp_path / "a.h5")), tmp_path / "out")
    monkeypatch.setattr("calib.recording.folder_recording._STRETCH_BYTES", 7 * 48 * 2)
    assert [len(dn) for dn in folder.frames("001")] == [7, 7, 6]
    assert np.array_equal(np.concatenate(list(folder.frames("001"))), codes("001", 20))


def statistics_only(folder: Path, rows: str) -> Path:
    for path in (folder / "frames").iterdir():
        path.unlink()
    (folder / "frames").rmdir()
    (folder / "statistics.csv").write_text("block,samples,mean_dn,variance_dn2\n" + rows)
    return folder


def test_sums_alone_are_given_and_frames_said_to_be_missing(tmp_path: Path) -> None:
    export_folder(open_recording(write_recording(tmp_path / "a.h5")), tmp_path / "out")
    folder = FolderRecording(statistics_only(tmp_path / "out", "000,100,12.5,2.25\n001,9,30,\n"))
    assert [(row.block, row.samples, row.variance_dn2) for row in folder.statistics] == [
        ("000", 100, 2.25),
        ("001", 9, None),
    ]
    for use in (
        lambda: folder.frames("000"),
        lambda: column_statistics(folder),
        lambda: import_folder(folder.path, tmp_path / "b.h5"),
    ):
        with pytest.raises(NotDeterminedError, match=r"needs frames/000\.npy"):
            use()
    assert not list(tmp_path.glob("*b.h5"))


@pytest.mark.parametrize("row", ["9,1,1,1", "000,0,1,1", "000,1,nan,1", "000,1,1,-1", "000,x,1,1"])
def test_sums_that_cannot_be_are_refused(tmp_path: Path, row: str) -> None:
    export_folder(open_recording(write_recording(tmp_path / "a.h5")), tmp_path / "out")
    with pytest.raises(InputError, match="row 2"):
        FolderRecording(statistics_only(tmp_path / "out", row))


def test_a_full_disk_leaves_nothing_half_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    recording = open_recording(write_recording(tmp_path / "a.h5"))
    folder = export_folder(recording, tmp_path / "out")
    before = set(tmp_path.rglob("*"))

    def full(*_: object) -> None:
        raise OSError(28, os.strerror(28))

    monkeypatch.setattr(os, "posix_fallocate", full)
    monkeypatch.setattr("calib.recording.folder.conditions_to_csv", full)
    for use in (
        lambda: import_folder(folder.path, tmp_path / "b.h5"),
        lambda: export_folder(recording, tmp_path / "other"),
    ):
        with pytest.raises(DarkflatError, match="no space left") as refused:
            use()
        assert refused.value.code == "disk-full"
    assert set(tmp_path.rglob("*")) == before


def test_outputs_that_exist_are_kept(tmp_path: Path) -> None:
    recording = open_recording(write_recording(tmp_path / "a.h5"))
    export_folder(recording, tmp_path / "out")
    for use in (
        lambda: export_folder(recording, tmp_path / "out"),
        lambda: import_folder(tmp_path / "out", tmp_path / "a.h5"),
    ):
        with pytest.raises(InputError, match="exists already"):
            use()
