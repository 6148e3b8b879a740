"""The radiance that a scene sends into the lens, by line and column."""

import numpy as np
from numpy.typing import NDArray

from calib.arrays import Lines
from calib.errors import InputError


def as_scene(scene: Lines | None, n_lines: int, n_columns: int) -> NDArray[np.float64]:
    """Return a radiance image, (1, n_columns) or (n_lines, n_columns); dark where None.

    A single line, (n_columns,) or (1, n_columns), stands for all lines.

    Raises:
        InputError: The shape does not fit, or a radiance is negative or not finite.
    """
    if scene is None:
        return np.zeros((1, n_columns))
    image = np.atleast_2d(np.asarray(scene, dtype=np.float64))
    if image.shape not in ((1, n_columns), (n_lines, n_columns)):
        raise InputError(
            f"scene: its shape is {np.shape(scene)}; give ({n_lines}, {n_columns}) or one line "
            f"of {n_columns} columns.",
            code="scene-shape",
        )
    if not (np.isfinite(image).all() and image.min() >= 0):
        raise InputError(
            "scene: a radiance is negative or not finite; give finite values from 0 on.",
            code="scene-radiance",
        )
    return image
