"""The radiance that a scene sends into the lens, by line and pixel."""

import numpy as np
from numpy.typing import NDArray

from calib.arrays import Lines
from calib.errors import InputError


def as_scene(scene: Lines | None, n_lines: int, sample: tuple[int, ...]) -> NDArray[np.float64]:
    """Return a radiance image, (1, *sample) or (n_lines, *sample); dark where None.

    A single one, (*sample,) or (1, *sample), stands for all lines, or frames.

    Raises:
        InputError: The shape does not fit, or a radiance is negative or not finite.
    """
    if scene is None:
        return np.zeros((1, *sample))
    image = np.asarray(scene, dtype=np.float64)
    image = image[np.newaxis] if image.ndim == len(sample) else image
    if image.shape not in ((1, *sample), (n_lines, *sample)):
        raise InputError(
            f"scene: its shape is {np.shape(scene)}; give {(n_lines, *sample)}, or {sample} for "
            f"all {n_lines} alike.",
            code="scene-shape",
        )
    if not (np.isfinite(image).all() and image.min() >= 0):
        raise InputError(
            "scene: a radiance is negative or not finite; give finite values from 0 on.",
            code="scene-radiance",
        )
    return image


def bar(n_columns: int) -> NDArray[np.float64]:
    """Return which share of the light a target lets through, (n_columns,): its middle third alone.

    The plainest scene with edges: an opaque plate with a slit, one edge on either side, one nearer
    to the register's output than the other.
    """
    columns = np.arange(n_columns)
    return ((columns >= n_columns // 3) & (columns < 2 * n_columns // 3)).astype(np.float64)
