"""Reads a folder with `[edge]`: one image or more of the same edge, whose mean is taken."""

from pathlib import Path

import numpy as np

from calib.errors import InputError
from calib.mtf.edge.edge_result import EdgeView
from calib.mtf.edge.slanted_edge import Vector
from calib.mtf.reading import MtfToml, read_image


def read_edge(folder: Path, read: MtfToml) -> tuple[Vector, EdgeView]:
    """Return the mean image, its edge across the columns, and how it was seen.

    Raises:
        InputError: `frames-missing`, or what `read_image` says.
    """
    assert read.edge is not None  # noqa: S101
    paths = sorted((folder / "frames").glob("*.npy"))
    if not paths:
        msg = f"{folder / 'frames'} holds no image of the edge: add 000.npy, or more to be averaged"
        raise InputError(msg, code="frames-missing")
    images = [read_image(path) for path in paths]
    for path, image in zip(paths, images, strict=True):
        if image.shape != images[0].shape:
            msg = f"{path} has shape {image.shape}, but {paths[0].name} has {images[0].shape}:"
            raise InputError(f"{msg} record all frames alike", code="frames-wrong-shape")
    mean = np.mean(images, axis=0)
    view = EdgeView(read.pitch_um, read.edge.direction, read.edge.moving, read.unknown_keys())
    return (mean if view.direction == "x" else mean.T), view
