"""Folders that cannot be used as they are: one sentence, a stable code, nothing written."""
# ruff: noqa: E501 - a table is read by rows

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import tifffile
from astropy.io import fits

from calib.errors import InputError
from calib.recording.folder import export_folder, import_folder
from calib.recording.open import open_recording
from tests.calib.recording.examples import codes, write_recording

Damage = Callable[[Path], object]


def text(name: str, old: str, new: str) -> Damage:
    def replace(folder: Path) -> None:
        before = (folder / name).read_text()
        assert old in before
        (folder / name).write_text(before.replace(old, new, 1))

    return replace


def npy(dn: object, name: str = "001") -> Damage:
    return lambda folder: np.save(folder / f"frames/{name}.npy", dn)  # type: ignore[arg-type]


def cut(name: str, n_bytes: int) -> Damage:
    def shorten(folder: Path) -> None:
        content = (folder / name).read_bytes()
        (folder / name).write_bytes(content[:n_bytes])

    return shorten


def remove(name: str) -> Damage:
    return lambda folder: (folder / name).unlink()


def instead(ending: str, write: Callable[[Path], object]) -> Damage:
    def replace(folder: Path) -> None:
        (folder / "frames/001.npy").unlink()
        write(folder / f"frames/001{ending}")

    return replace


def truncated_fits(path: Path) -> None:
    fits.writeto(path, codes("001", 20))
    path.write_bytes(path.read_bytes()[:3000])


def truncated_tiff(path: Path) -> None:
    tifffile.imwrite(path, codes("001", 20), photometric="minisblack")
    path.write_bytes(path.read_bytes()[:1500])


RGB = np.zeros((20, 48, 3), np.uint16)
CSV, TOML = "conditions.csv", "recording.toml"
CASES: list[tuple[str, Damage, str, str]] = [
    ("truncated npy", cut("frames/001.npy", 700), "frames-truncated", "001.npy is truncated"),
    ("npy cut in its header", cut("frames/001.npy", 20), "frames-truncated", "copy it again"),
    ("empty npy", cut("frames/001.npy", 0), "frames-truncated", "001.npy"),
    ("npy that is text", lambda f: (f / "frames/001.npy").write_text("x" * 500), "frames-unreadable", "001.npy"),
    ("npy of objects", npy(np.array([[None]])), "frames-unreadable", "objects"),
    ("npy in Fortran order", npy(np.asfortranarray(codes("001", 20))), "frames-unreadable", "Fortran"),
    ("renamed frames", lambda f: (f / "frames/001.npy").rename(f / "frames/1.npy"), "frames-missing", "block 001"),
    ("missing frames", remove("frames/002.npy"), "frames-missing", r"002\.npy"),
    ("extra frames", npy(codes("009", 20), "009"), "frames-extra", "009"),
    ("two files", lambda f: tifffile.imwrite(f / "frames/001.tif", codes("001", 20)), "frames-ambiguous", "keep one"),
    ("too few columns", npy(codes("001", 20)[:, 1:].copy()), "frames-wrong-shape", r"\(20, 47\)"),
    ("a single line flat", npy(codes("001", 20)[0]), "frames-wrong-shape", r"\(48,\)"),
    ("no lines", npy(codes("001", 20)[:0]), "frames-wrong-shape", r"\(0, 48\)"),
    ("a stack for lines", npy(np.zeros((2, 10, 48), np.uint16)), "frames-wrong-shape", "2, 10, 48"),
    ("floats", npy(codes("001", 20).astype(np.float32)), "frames-wrong-dtype", "float32"),
    ("signed", npy(codes("001", 20).astype(np.int16)), "frames-wrong-dtype", "int16"),
    ("bytes for 12 bits", npy(np.zeros((20, 48), np.uint8)), "frames-wrong-dtype", "uint8"),
    ("code above full scale", npy(np.full((20, 48), 4096, np.uint16)), "code-above-full-scale", "4096"),
    ("lines mismatch", npy(codes("001", 19)), "lines-mismatch", "19 lines.*20"),
    ("colour tiff", instead(".tif", lambda p: tifffile.imwrite(p, RGB, photometric="rgb")), "frames-not-monochrome", "colour"),
    ("float tiff", instead(".tif", lambda p: tifffile.imwrite(p, codes("001", 20).astype(np.float32))), "frames-wrong-dtype", "float32"),
    ("truncated tiff", instead(".tif", truncated_tiff), "frames-truncated", "001.tif"),
    ("tiff that is text", instead(".tif", lambda p: p.write_text("hello")), "frames-unreadable", "001.tif"),
    ("truncated fits", instead(".fits", truncated_fits), "frames-truncated", "001.fits"),
    ("float fits", instead(".fits", lambda p: fits.writeto(p, codes("001", 20).astype(np.float32))), "frames-wrong-dtype", "float32"),
    ("fits that is text", instead(".fits", lambda p: p.write_text("hello")), "frames-unreadable", "001.fits"),
    ("raw without dtype", instead(".raw", lambda p: codes("001", 20).tofile(p)), "raw-dtype-unknown", "dtype"),
    ("no recording.toml", remove(TOML), "recording-incomplete", "recording.toml is missing"),
    ("no conditions.csv", remove(CSV), "recording-incomplete", "conditions.csv is missing"),
    ("toml syntax", text(TOML, "columns =", "columns"), "header-invalid", "not TOML"),
    ("no columns", text(TOML, "columns = 48\n", ""), "header-invalid", "camera.columns is missing"),
    ("bit depth 20", text(TOML, "bit_depth = 12", "bit_depth = 20"), "header-invalid", "bit_depth = 20"),
    ("missing column", text(CSV, "exposure_us", "exposure"), "conditions-missing-columns", "exposure_us"),
    ("column twice", text(CSV, "radiance", "lines"), "conditions-missing-columns", "radiance"),
    ("short row", text(CSV, "001,flat,", "001,"), "conditions-invalid", "row 3"),
    ("NaN radiance", text(CSV, ",0.1\n", ",nan\n"), "radiance-invalid", "row 3.*radiance"),
    ("negative radiance", text(CSV, ",0.1\n", ",-0.1\n"), "radiance-invalid", "row 3.*radiance"),
    ("infinite radiance", text(CSV, ",0.1\n", ",inf\n"), "radiance-invalid", "row 3.*radiance"),
    ("no exposure", text(CSV, "000,dark,100.0,", "000,dark,,"), "conditions-invalid", "row 2.*exposure_us"),
    ("unknown kind", text(CSV, "000,dark", "000,black"), "conditions-invalid", "row 2.*kind"),
    ("flat of unknown level", text(CSV, "33,1.0,", "33,,") , "conditions-invalid", "level"),
    ("duplicate block", text(CSV, "002,flat", "001,flat"), "duplicate-block", "001 is there twice"),
    ("out of order", text(CSV, ",3.0,,20,", ",1.0,,20,"), "conditions-out-of-order", "in the order"),
    ("path for a name", text(CSV, "002,flat", "../002,flat"), "block-name-invalid", "name"),
    ("no rows", cut(CSV, 75), "recording-incomplete", "no rows"),
]  # fmt: skip


@pytest.fixture(scope="module")
def sound(tmp_path_factory: pytest.TempPathFactory) -> Path:
    root = tmp_path_factory.mktemp("sound")
    return export_folder(open_recording(write_recording(root / "a.h5")), root / "out").path


@pytest.mark.parametrize(
    ("damage", "code", "words"), [case[1:] for case in CASES], ids=[case[0] for case in CASES]
)
def test_a_bad_folder_is_refused_in_one_sentence(
    tmp_path: Path, sound: Path, damage: Damage, code: str, words: str
) -> None:
    folder = tmp_path / "in"
    (folder / "frames").mkdir(parents=True)
    for path in sound.rglob("*.*"):
        (folder / path.relative_to(sound)).write_bytes(path.read_bytes())
    damage(folder)
    with pytest.raises(InputError, match=words) as refused:
        import_folder(folder, tmp_path / "b.h5")
    assert refused.value.code == code
    assert "\n" not in str(refused.value)
    assert [path.name for path in tmp_path.iterdir()] == ["in"]
