"""Reads the folder of contract §6: `mtf.toml` and `frames/`."""

import tomllib
from pathlib import Path
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from calib.errors import InputError, reason_of
from calib.mtf.frame_files import check_names, read_alike
from calib.mtf.geometry import Scan
from calib.mtf.grating.grating import Grating
from calib.mtf.scan_images import ScanImages
from calib.recording.recording_toml import first_problem

_MOST_POSITIONS = 1000  # numbered by three digits
_MOST_HARMONICS = 5000  # of a pair each one: the normal matrix takes 0.8 GB
_MOST_ETA2 = 10**9


class _Table(BaseModel):
    model_config = ConfigDict(extra="allow", frozen=True)


class GratingTable(_Table):
    """`[grating]`."""

    eta2: int = Field(le=_MOST_ETA2)
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

    direction: Literal["x", "y"] = "x"
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
    _check_tables(path, read)
    return read


def _check_tables(path: Path, read: MtfToml) -> None:
    """Refuse a header of neither a grating nor an edge, and one of both."""
    if read.edge is None and (read.grating is None or read.scan is None):
        lacking = "[grating]" if read.grating is None else "[scan]"
        msg = f"{path}: {lacking} is missing: add it, or [edge] for an edge without a grating"
        raise InputError(msg, code="header-invalid")
    if read.edge is not None and (read.grating is not None or read.scan is not None):
        msg = f"{path} has [edge] beside a grating's tables: a folder holds one or the other, so"
        raise InputError(f"{msg} remove what was not recorded", code="header-invalid")


def read_scan(folder: Path, read: MtfToml) -> ScanImages:
    """Read the frames of a scan with a grating.

    Raises:
        InputError: See `check_names` and `read_alike`; `not-coprime`, `too-many-positions`,
            `missing-wrong`, `no-orders`, `bad-grating`, `bad-pitch` or `too-many-harmonics`.
    """
    assert read.grating is not None and read.scan is not None  # noqa: S101, PT018
    scan = Scan(read.pitch_um, read.scan.m, read.scan.n)
    grating = Grating(read.grating.eta2, read.grating.period_um)
    _check_size(folder / "mtf.toml", scan, grating)
    positions = _positions(folder / "mtf.toml", scan, read.scan.missing)
    paths = [folder / "frames" / f"{k:03d}.npy" for k in positions]
    check_names(folder / "frames", paths, scan.positions)
    return ScanImages(scan, grating, read_alike(paths), positions)


def _check_size(toml: Path, scan: Scan, grating: Grating) -> None:
    """Refuse what no folder can hold and no machine reduces."""
    if scan.positions > _MOST_POSITIONS:
        msg = f"{toml}: m = {scan.m} and n = {scan.n} make {scan.positions} positions, but frames"
        msg += " are numbered 000 to 999: choose smaller ones, such as 1 and 6"
        raise InputError(msg, code="too-many-positions")
    if len(grating.harmonics) > _MOST_HARMONICS:
        msg = f"{toml}: eta2 = {grating.eta2} makes {grating.harmonics.count} harmonics, more than"
        msg += f" {2 * _MOST_HARMONICS}: take a grating of fewer orders, such as 650 or 5525"
        raise InputError(msg, code="too-many-harmonics")


def _positions(toml: Path, scan: Scan, missing: tuple[int, ...]) -> tuple[int, ...]:
    """Return the stage positions that were recorded."""
    unknown = sorted(set(missing) - set(range(scan.positions)))
    if unknown:
        msg = f"{toml}: missing names {unknown[0]}, but positions are 0 to {scan.positions - 1}:"
        raise InputError(f"{msg} correct it", code="missing-wrong")
    positions = tuple(k for k in range(scan.positions) if k not in set(missing))
    if not positions:
        msg = f"{toml}: missing names every position, so that nothing is left: record the scan"
        raise InputError(msg, code="missing-wrong")
    return positions
