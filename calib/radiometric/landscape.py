"""A landscape under a clear sky, as a line sensor sees it while it is swept across.

The sensor stands upright, as in Olsen et al. 2010 (AgCam), section 6 and Figs. 8 and 9: a line is a
vertical strip of the scene, column 0 at its lower end, and the lines follow each other in azimuth.
At the sweep's start the ground lies below the field of view, so that the first lines see sky alone.
"""

from dataclasses import dataclass

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from calib.errors import InputError

_ROWS_IN_SIGHT, _ROWS, _FIELDS = 2.0, 16, 5
"""Rows of fields are numbered from the first at the lower edge to the second at the horizon;
each has so many fields."""

RadianceImage = NDArray[np.float64]
"""(n_lines, n_columns)."""


@dataclass(frozen=True)
class Landscape:
    """How bright its parts are; each a radiance in the unit of the camera's set.

    Attributes:
        sky: Radiance of the sky, the same everywhere.
        field: Mean radiance of the fields; vegetation is bright in the NIR, dark in the red.
        woods: Mean radiance of the tree line that stands on the horizon.
        contrast: Relative standard deviation of what single fields and their texture differ by.
        horizon: Where the horizon ends up at the end of the sweep, as a share of the line.
        sky_lines: The share of the sweep that sees sky alone.
    """

    sky: float
    field: float
    woods: float
    contrast: float = 0.25
    horizon: float = 0.45
    sky_lines: float = 0.15

    def __post_init__(self) -> None:
        if min(self.sky, self.field, self.woods, self.contrast) < 0:
            msg = "A landscape's radiances and contrast must not be negative."
            raise InputError(msg, code="bad-landscape")
        if not (0 <= self.horizon <= 1 and 0 <= self.sky_lines <= 1):
            msg = "A landscape's horizon and sky lines are shares from 0 to 1."
            raise InputError(msg, code="bad-landscape")

    def image(self, n_lines: int, n_columns: int, rng: Generator) -> RadianceImage:
        """Return the radiance; the same generator state gives the same landscape."""
        horizon, treetops = self._outlines(n_lines, n_columns, rng)
        ground = self._ground(horizon, n_columns, rng)
        column = np.arange(n_columns)[None, :]
        woods = self.woods * (1 + self.contrast * _texture((n_lines, n_columns), 3, rng))
        image = np.where(column < treetops[:, None], np.maximum(woods, 0.0), self.sky)
        image = np.where(column < horizon[:, None], ground, image)
        return np.asarray(image, np.float64)

    def is_sky(self, image: RadianceImage) -> NDArray[np.bool_]:
        """Return which pixels of `image` see nothing but sky."""
        return np.equal(image, self.sky)

    def _outlines(
        self, n_lines: int, n_columns: int, rng: Generator
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return up to which column ground and treetops reach in each line, (n_lines,) each."""
        along = np.linspace(0.0, 1.0, n_lines)
        rise = np.clip((along - self.sky_lines) / max(1 - self.sky_lines, 1e-9), 0.0, 1.0)
        hills = 0.03 * _smooth(rng.normal(size=n_lines), max(n_lines // 12, 1))
        horizon = np.where(rise > 0, self.horizon * np.sqrt(rise) + hills * rise, 0.0)
        height = 0.02 + 0.025 * np.abs(_smooth(rng.normal(size=n_lines), max(n_lines // 90, 1)))
        treetops = np.where(rise > 0, horizon + height * np.sqrt(rise), 0.0)
        return horizon * n_columns, treetops * n_columns

    def _ground(
        self, horizon: NDArray[np.float64], n_columns: int, rng: Generator
    ) -> RadianceImage:
        """Return fields of different brightness, which shrink towards the horizon, with texture."""
        n_lines = len(horizon)
        height = np.arange(n_columns)[None, :] / np.maximum(horizon, 1.0)[:, None]
        below = np.clip(1.0 - height, 0.0, 1.0)
        row = np.floor(_ROWS_IN_SIGHT / np.maximum(below, _ROWS_IN_SIGHT / _ROWS)).astype(np.intp)
        along = np.arange(n_lines)[:, None] / n_lines
        field = np.floor(_FIELDS * (along + rng.uniform(size=_ROWS + 1)[row])).astype(np.intp)
        of_field = 1 + self.contrast * rng.normal(size=(_ROWS + 1, 2 * _FIELDS + 1))
        texture = _texture((n_lines, n_columns), 9, rng)
        brightness = of_field[row, field] * (1 + 0.3 * self.contrast * texture)
        return self.field * np.maximum(brightness, 0.05)


def _smooth(values: NDArray[np.float64], length: int) -> NDArray[np.float64]:
    """Return the running mean over `length` samples along the first axis, scaled to spread 1."""
    padded = np.concatenate([values[:1].repeat(length, 0), values, values[-1:].repeat(length, 0)])
    sums = np.cumsum(padded, axis=0)
    mean = (sums[length:] - sums[:-length])[: len(values)] / length
    spread = float(mean.std())
    return np.asarray((mean - mean.mean()) / (spread if spread > 0 else 1.0), np.float64)


def _texture(shape: tuple[int, int], length: int, rng: Generator) -> NDArray[np.float64]:
    """Return noise of spread 1 whose grains are `length` pixels wide."""
    return _smooth(_smooth(rng.normal(size=shape), length).T, length).T
