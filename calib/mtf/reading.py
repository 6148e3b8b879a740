"""Reads the folder of contract §6: `mtf.toml` and `frames/`."""

import tomllib
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from calib.errors import InputError, reason_of
from calib.mtf.geometry import Scan
from calib.mtf.grating.grating import Grating
from calib.mtf.scan_images import ScanImages
from calib.recording.recording_toml import first_problem

Image = NDArray[np.floating]


class _Table(BaseModel):
    model_config = ConfigDict(extra="allow", frozen=True)


class GratingTable(_Table):
    """`[grating]`."""

    eta2: int
    period_um: float


class ScanTable(_Table):
    """`[scan]`; `missing` names stage positions that were not recorded."""

    m: int
    n: int
    missing: tuple[int, ...] = ()


class EdgeTable(_Table):
    """`[edge]`, in place of a grating: an edge across columns ("x") or rows ("y").

    `moving`: a straight edge that moves along a line sensor, lines being the images' rows.
    """

    direction: str = Field(default="x", pattern="^[xy]$")
    moving: bool = False


class MtfToml(_Table):
    """`mtf.toml`."""

    pitch_um: float
    grating: GratingTable | None = None
    scan: ScanTable | None = None
    edge: EdgeTable | None = None

    def unknown_keys(self) -> tuple[str, ...]:
        """Return keys that darkflat does not know."""
        parts = {"": self, "grating.": self.grating, "scan.": self.scan, "edge.": self.edge}
        return tuple(
            prefix + key
            for prefix, part in parts.items()
            if part is not None
            for key in part.model_extra or {}
        )


def read_toml(folder: Path) -> MtfToml:
    """Read `mtf.toml`.

    Raises:
        InputError: `not-a-folder`, `not-found`, or `header-invalid` with the key that is wrong.
    """
    path = folder / "mtf.toml"
    if not folder.is_dir():
        msg = f"{folder} is no folder: name the folder that holds mtf.toml and frames/"
        raise InputError(msg, code="not-a-folder")
    try:
        content: dict[str, Any] = tomllib.loads(path.read_text(encoding="utf-8"))
        read = MtfToml.model_validate(content)
    except FileNotFoundError as error:
        msg = f"mtf.toml is missing in {folder}: add it"
        raise InputError(msg, code="not-found") from error
    except ValidationError as error:
        raise InputError(f"{path}: {first_problem(error)}", code="header-invalid") from error
    except (OSError, ValueError, RecursionError) as error:
        msg = f"{path} cannot be read ({reason_of(error)}): correct it"
        raise InputError(msg, code="header-invalid") from error
    if read.edge is None and (read.grating is None or read.scan is None):
        lacking = "[grating]" if read.grating is None else "[scan]"
        msg = f"{path}: {lacking} is missing: add it, or [edge] for an edge without a grating"
        raise InputError(msg, code="header-invalid")
    return read


def read_scan(folder: Path, read: MtfToml) -> ScanImages:
    """Read the frames of a scan with a grating.

    Raises:
        InputError: See `read_image`; `frames-missing`, `frames-extra`, `not-coprime`, `no-orders` …
    """
    assert read.grating is not None and read.scan is not None  # noqa: S101, PT018
    scan = Scan(read.pitch_um, read.scan.m, read.scan.n)
    grating = Grating(read.grating.eta2, read.grating.period_um)
    absent = set(read.scan.missing)
    positions = tuple(k for k in range(scan.positions) if k not in absent)
    paths = [folder / "frames" / f"{k:03d}.npy" for k in positions]
    _check_names(folder / "frames", paths, scan.positions)
    images = [read_image(path) for path in paths]
    for path, image in zip(paths, images, strict=True):
        if image.shape != images[0].shape:
            msg = f"{path} has shape {image.shape}, but {paths[0].name} has {images[0].shape}:"
            raise InputError(f"{msg} record all frames alike", code="frames-wrong-shape")
    return ScanImages(scan, grating, np.stack(images), positions)


def read_image(path: Path) -> Image:
    """Read one mean image.

    Raises:
        InputError: `frames-unreadable`, `frames-wrong-shape`, `frames-wrong-dtype` or `frames-
            not-finite`.
    """
    try:
        image = np.load(path, allow_pickle=False)
    except (OSError, ValueError, EOFError) as error:
        msg = f"{path} cannot be read ({reason_of(error)}): save it again with numpy.save"
        raise InputError(msg, code="frames-unreadable") from error
    if image.dtype.kind not in "iuf":
        msg = f"{path} holds {image.dtype}, but a mean image holds numbers: save it as float64"
        raise InputError(msg, code="frames-wrong-dtype")
    if image.ndim != 2 or min(image.shape) < 2:
        msg = f"{path} has shape {image.shape}, but a mean image is (n_rows, n_columns): average"
        msg += " the frames of a position first"
        raise InputError(msg, code="frames-wrong-shape")
    wrong = np.argwhere(~np.isfinite(image))
    if len(wrong):
        row, column = wrong[0].tolist()
        msg = (
            f"{path} holds {image[row, column]} at row {row}, column {column}: replace what is not"
        )
        raise InputError(f"{msg} known by 0, odd pixels are left out", code="frames-not-finite")
    return np.asarray(image, np.float64)


def _check_names(folder: Path, paths: list[Path], n_positions: int) -> None:
    """Refuse a folder that lacks a frame or holds one too many."""
    if not folder.is_dir():
        raise InputError(f"{folder} is missing: add the frames", code="frames-missing")
    lacking = [path.stem for path in paths if not path.is_file()]
    if lacking:
        named = ", ".join(lacking[:5]) + (" …" if len(lacking) > 5 else "")
        numbers = ", ".join(str(int(each)) for each in lacking[:5])
        msg = (
            f"frame {named} is missing in {folder}: put it back, or say missing = [{numbers}] under"
        )
        raise InputError(f"{msg} [scan] to do without", code="frames-missing")
    extra = sorted({each.name for each in folder.glob("*.npy")} - {path.name for path in paths})
    if extra:
        msg = (
            f"{folder} holds {extra[0]}, but m and n make {n_positions} positions: move it away, or"
        )
        raise InputError(f"{msg} correct m, n and missing", code="frames-extra")
