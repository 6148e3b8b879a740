"""A folder that cannot be used is refused in one sentence that says what and where."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from numpy.random import default_rng

from calib.errors import InputError
from calib.mtf.reading import read_scan, read_toml
from calib.mtf.simulation.folder import write_folder
from tests.calib.mtf.simulated import ORDERS_12, SMALL, record


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    case = record(default_rng(), (8, 9), scan=SMALL, grating=ORDERS_12)
    return write_folder(tmp_path / "scan", SMALL, ORDERS_12, case.scan.images)


def test_a_folder_comes_back_as_it_was_written(folder: Path) -> None:
    read = read_toml(folder)
    scan = read_scan(folder, read)
    assert (scan.scan, scan.grating) == (SMALL, ORDERS_12)
    assert scan.positions == tuple(range(10))
    np.testing.assert_array_equal(scan.images[3], np.load(folder / "frames" / "003.npy"))
    assert read.unknown_keys() == ()


def test_positions_that_are_said_to_be_missing_are_done_without(tmp_path: Path) -> None:
    images = record(default_rng(), (8, 9), scan=SMALL, grating=ORDERS_12).scan.images
    folder = write_folder(tmp_path / "scan", SMALL, ORDERS_12, images, missing=(2, 7))
    assert read_scan(folder, read_toml(folder)).positions == (0, 1, 3, 4, 5, 6, 8, 9)


def test_codes_are_read_as_numbers_and_unknown_keys_are_named(folder: Path) -> None:
    for path in (folder / "frames").iterdir():
        np.save(path, np.load(path).astype(np.uint16))
    toml = folder / "mtf.toml"
    toml.write_text('operator = "N. N."\n' + toml.read_text() + "speed = 3\n")
    read = read_toml(folder)
    assert read_scan(folder, read).images.dtype == np.float64
    assert read.unknown_keys() == ("operator", "scan.speed")


def _toml(old: str, new: str) -> Callable[[Path], None]:
    def damage(folder: Path) -> None:
        path = folder / "mtf.toml"
        assert old in path.read_text()
        path.write_text(path.read_text().replace(old, new))

    return damage


def _frame(change: Callable[[np.ndarray], np.ndarray]) -> Callable[[Path], None]:
    def damage(folder: Path) -> None:
        path = folder / "frames" / "004.npy"
        np.save(path, change(np.load(path)))

    return damage


def _with_nan(image: np.ndarray) -> np.ndarray:
    image[2, 5] = np.nan
    return image


DAMAGES = [
    (_toml("m = 1", "m = 3"), "not-coprime", "m = 3 and n = 3"),
    (_toml("m = 1", "m = -1"), "not-coprime", "m = -1"),
    (_toml("pitch_um = 25.0", "pitch_um = 0.0"), "bad-pitch", "pitch_um = 0.0"),
    (_toml("pitch_um = 25.0", ""), "header-invalid", "pitch_um is missing"),
    (_toml("eta2 = 50", "eta2 = 51"), "no-orders", "eta2 = 51"),
    (_toml("eta2 = 50", 'eta2 = "fifty"'), "header-invalid", "grating.eta2"),
    (_toml("period_um = 340.0", "period_um = -1.0"), "bad-grating", "-1.0"),
    (_toml("[grating]", "[grate]"), "header-invalid", "[grating] is missing"),
    (_toml("[scan]", "[scans]"), "header-invalid", "[scan] is missing"),
    (_toml("pitch_um", "pitch um"), "header-invalid", "mtf.toml"),
    (lambda folder: (folder / "mtf.toml").unlink(), "not-found", "mtf.toml is missing"),
    (lambda folder: (folder / "frames" / "004.npy").unlink(), "frames-missing", "missing = [4]"),
    (lambda folder: (folder / "frames").rename(folder / "pictures"), "frames-missing", "frames"),
    (
        lambda folder: np.save(folder / "frames" / "010.npy", np.ones((8, 9))),
        "frames-extra", "010.npy",
    ),
    (_frame(lambda image: image[:, 1:]), "frames-wrong-shape", "004.npy has shape (8, 8)"),
    (_frame(lambda image: image[None]), "frames-wrong-shape", "004.npy has shape (1, 8, 9)"),
    (_frame(_with_nan), "frames-not-finite", "004.npy holds nan at row 2, column 5"),
    (_frame(lambda image: image + 1j), "frames-wrong-dtype", "complex128"),
    (
        lambda folder: (folder / "frames" / "004.npy").write_bytes(b"\x93NUMPY"),
        "frames-unreadable", "004.npy cannot be read",
    ),
    (
        lambda folder: np.save(folder / "frames" / "004.npy", np.array([{}]), allow_pickle=True),
        "frames-unreadable", "004.npy cannot be read",
    ),
]  # fmt: skip


@pytest.mark.parametrize(("damage", "code", "named"), DAMAGES)
def test_damage_is_named(
    folder: Path, damage: Callable[[Path], None], code: str, named: str
) -> None:
    damage(folder)
    with pytest.raises(InputError) as refused:
        read_scan(folder, read_toml(folder))
    assert refused.value.code == code
    assert named in str(refused.value)
    assert "\n" not in str(refused.value)


def test_a_folder_that_is_not_there_is_no_folder(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no folder"):
        read_toml(tmp_path / "nowhere")
