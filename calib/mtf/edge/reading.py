"""Reads a folder with `[edge]`: one image or more of the same edge, whose mean is taken."""

from pathlib import Path

from calib.errors import InputError
from calib.mtf.edge.edge_result import EdgeView
from calib.mtf.edge.slanted_edge import Vector
from calib.mtf.frame_files import read_alike
from calib.mtf.geometry import check_pitch
from calib.mtf.reading import MtfToml


def read_edge(folder: Path, read: MtfToml) -> tuple[Vector, EdgeView]:
    """Return the mean image, its edge across the columns, and how it was seen.

    Raises:
        InputError: `bad-pitch`, `frames-missing`, or what `read_alike` says.
    """
    assert read.edge is not None  # noqa: S101
    check_pitch(read.pitch_um)
    paths = sorted((folder / "frames").glob("*.npy"))
    if not paths:
        msg = f"{folder / 'frames'} holds no image of the edge: add 000.npy, or more to be averaged"
        raise InputError(msg, code="frames-missing")
    mean = read_alike(paths).mean(axis=0)
    view = EdgeView(read.pitch_um, read.edge.direction, read.edge.moving, read.unknown_keys())
    return (mean if view.direction == "x" else mean.T), view
