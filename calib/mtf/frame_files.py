"""Reads mean images of one shape from a folder `frames/`, or says what is wrong with which."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from calib.errors import InputError, reason_of

Image = NDArray[np.floating]
_LARGEST = (
    1e9  # DN or electrons; beyond, a file was read with the wrong byte order, or never filled
)


def read_alike(paths: Sequence[Path]) -> NDArray[np.floating]:
    """Read images of one shape, (n_images, n_rows, n_columns).

    Raises:
        InputError: See `read_image`; `frames-wrong-shape` where they differ.
    """
    images = [read_image(path) for path in paths]
    for path, image in zip(paths, images, strict=True):
        if image.shape != images[0].shape:
            msg = f"{path} has shape {image.shape}, but {paths[0].name} has {images[0].shape}:"
            raise InputError(f"{msg} record all frames alike", code="frames-wrong-shape")
    return np.stack(images)


def read_image(path: Path) -> Image:
    """Read one mean image; a line sensor's has one row.

    Raises:
        InputError: `frames-unreadable`, `frames-wrong-shape`, `frames-wrong-dtype`,
            `frames-not-finite` or `frames-out-of-range`.
    """
    image = _loaded(path)
    if image.dtype.kind not in "iuf":
        msg = f"{path} holds {image.dtype}, but a mean image holds numbers: save it as float64"
        raise InputError(msg, code="frames-wrong-dtype")
    if image.ndim != 2 or image.shape[1] < 2 or not len(image):
        msg = f"{path} has shape {image.shape}, but a mean image is (n_rows, n_columns): average"
        msg += " the frames of a position first"
        raise InputError(msg, code="frames-wrong-shape")
    known = np.asarray(image, np.float64)
    _check_values(path, known)
    return known


def check_names(folder: Path, paths: Sequence[Path], n_positions: int) -> None:
    """Refuse a folder that lacks a frame or holds one too many.

    Raises:
        InputError: `frames-missing` or `frames-extra`.
    """
    if not folder.is_dir():
        raise InputError(f"{folder} is missing: add the frames", code="frames-missing")
    lacking = [path.stem for path in paths if not path.is_file()]
    if lacking:
        named = ", ".join(lacking[:5]) + (" …" if len(lacking) > 5 else "")
        numbers = ", ".join(str(int(each)) for each in lacking[:5])
        what = "frame" if len(lacking) == 1 else "frames"
        verb, them = ("is", "it") if len(lacking) == 1 else ("are", "them")
        msg = f"{what} {named} {verb} missing in {folder}: put {them} back, or say missing ="
        raise InputError(f"{msg} [{numbers}] under [scan] to do without", code="frames-missing")
    extra = sorted({each.name for each in folder.glob("*.npy")} - {path.name for path in paths})
    if extra:
        msg = (
            f"{folder} holds {extra[0]}, but m and n make {n_positions} positions: move it away, or"
        )
        raise InputError(f"{msg} correct m, n and missing", code="frames-extra")


def _loaded(path: Path) -> NDArray[np.generic]:
    try:
        image = np.load(path, allow_pickle=False)
    except (OSError, ValueError, EOFError) as error:
        reason = reason_of(error).partition(". ")[0]
        msg = f"{path} cannot be read ({reason}): save it again with numpy.save"
        raise InputError(msg, code="frames-unreadable") from error
    if not isinstance(image, np.ndarray):
        image.close()
        msg = f"{path} holds several arrays, as numpy.savez writes them: save one by numpy.save"
        raise InputError(msg, code="frames-unreadable")
    return image


def _check_values(path: Path, image: Image) -> None:
    wrong = np.argwhere(~np.isfinite(image))
    if len(wrong):
        row, column = wrong[0].tolist()
        msg = (
            f"{path} holds {image[row, column]} at row {row}, column {column}: replace what is not"
        )
        raise InputError(f"{msg} known by 0, odd pixels are left out", code="frames-not-finite")
    if np.abs(image).max() > _LARGEST:
        row, column = (int(each) for each in np.unravel_index(np.abs(image).argmax(), image.shape))
        msg = f"{path} holds {image[row, column]:.3g} at row {row}, column {column}, which no mean"
        msg += " image does: save it in DN or electrons, in this machine's byte order"
        raise InputError(msg, code="frames-out-of-range")
