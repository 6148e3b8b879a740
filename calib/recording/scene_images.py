"""Radiance images under `scenes/`."""

from pathlib import Path

import numpy as np
import tifffile
from numpy.typing import NDArray

from calib.errors import InputError

_ENDINGS = ("", ".npy", ".tif", ".tiff", ".fits", ".fit")


def read_scene(folder: Path, name: str, n_columns: int) -> NDArray[np.float64]:
    """Return the image, (n_lines, n_columns) or (n_columns,), in the source's `radiance_unit`."""
    candidates = [folder / f"{name}{ending}" for ending in _ENDINGS]
    path = next((each for each in candidates if each.is_file()), None)
    if path is None:
        raise InputError(
            f"the scene {name} is missing in {folder}: add it there as {name}.npy",
            code="scene-missing",
        )
    scene = np.atleast_1d(_loaded(path))
    if scene.shape[-1] != n_columns:
        raise InputError(
            f"{path} has {scene.shape[-1]} columns, but the camera has {n_columns}: crop it",
            code="scene-invalid",
        )
    if not np.isfinite(scene).all() or (scene < 0).any():
        raise InputError(f"{path} holds NaN or negative radiance: correct it", code="scene-invalid")
    return scene


def _loaded(path: Path) -> NDArray[np.float64]:
    try:
        if path.suffix.lower() in (".tif", ".tiff"):
            return np.asarray(tifffile.imread(path), dtype=np.float64)
        if path.suffix.lower() in (".fits", ".fit"):
            from astropy.io import fits  # noqa: PLC0415  (slow to import, and seldom needed)

            with fits.open(path) as hdus:
                return np.asarray(hdus[0].data, dtype=np.float64)
        return np.asarray(np.load(path, allow_pickle=False), dtype=np.float64)
    except (ValueError, TypeError, OSError, EOFError, tifffile.TiffFileError) as error:
        raise InputError(
            f"{path} cannot be read ({error}): save it again", code="scene-invalid"
        ) from error
