"""The oversampled grid, s = pitch/√(m² + n²): every pixel of every stage position at its place."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.errors import NotDeterminedError
from calib.mtf.estimation.harmonic_fit import HarmonicFit
from calib.mtf.geometry import Sampling
from calib.mtf.grating.pattern import on_grid

Map = NDArray[np.floating]


@dataclass(frozen=True, eq=False)
class Oversampled:
    """An image on the grid of s, its mean light taken off; arrays are [y, x].

    The tilted detector covers a turned rectangle of the grid.

    Attributes:
        image: Of mean 0, relative to the mean light; 0 where nothing is covered.
        pattern: The pattern itself at the same points, of mean 0.
        covered: Which points a pixel has sampled, or would have at a missing stage position.
        step_um: s, µm.
        tilt_rad: By which the detector's columns are turned from the grid's.
    """

    image: Map
    pattern: Map
    covered: NDArray[np.bool_]
    step_um: float
    tilt_rad: float


def oversampled(
    fit: HarmonicFit, shift_um: NDArray[np.floating], *, select_harmonics: bool
) -> Oversampled:
    """Put the images on the grid, corrected for what the fit found.

    The harmonics are put where a perfect bench had sampled them, and the residual on top: errors
    of stage, tilt and scale, gain, offset and light of single frames, odd pixels and missing
    positions are no longer in it. With `select_harmonics` the residual is left out, as in Section
    6 of the paper.

    Raises:
        NotDeterminedError: `grid-too-coarse` where the pattern's harmonics alias on the grid.
    """
    state = fit.state
    sampling, harmonics = state.sampling, state.harmonics
    _check_grid(sampling, float(np.hypot(*harmonics.frequency_per_um.T).max()))
    column, row, covered = _places(sampling)
    x, y = (sampling.scan.step_um * (np.arange(n) + first) for n, first in (column, row))
    centre = sampling.centre_um - sampling.alignment.shift_um
    middle = 0.5 * sampling.scan.step_um * (sampling.scan.positions - 1)
    x, y = x + centre[0] + middle, y + centre[1]
    image = on_grid(harmonics, x, y, fit.transfer * harmonics.amplitude, 0.0)
    if not select_harmonics:
        image += _scattered(sampling, fit.residual, covered.shape) / fit.mean
    offset = shift_um - sampling.alignment.shift_um
    pattern = on_grid(harmonics, x - offset[0], y - offset[1], mean=0.0)
    tilt = sampling.scan.tilt_rad + sampling.alignment.tilt_rad
    return Oversampled(image * covered, pattern * covered, covered, sampling.scan.step_um, tilt)


def _check_grid(sampling: Sampling, highest: float) -> None:
    scan = sampling.scan
    if highest > scan.nyquist_per_um * (1 + 1e-9):
        msg = (
            f"the pattern reaches {1e3 * highest:.0f}/mm, but the oversampled grid carries no more"
        )
        msg += f" than {1e3 * scan.nyquist_per_um:.0f}/mm: scan with larger m and n, or use the"
        raise NotDeterminedError(f"{msg} regularised method", code="grid-too-coarse")


def _indices(sampling: Sampling, position: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the grid's x and y index of each pixel of a frame, (n_rows, n_columns) each."""
    row, column = np.arange(sampling.n_rows)[:, None], np.arange(sampling.n_columns)[None, :]
    m, n = sampling.scan.m, sampling.scan.n
    return column * n - row * m + position, column * m + row * n


def _places(
    sampling: Sampling,
) -> tuple[tuple[int, float], tuple[int, float], NDArray[np.bool_]]:
    """Return size and first index of the grid by column and by row, and what is covered.

    Indices count from the detector's centre at the middle stage position.
    """
    x, y = _indices(sampling, 0)
    last = sampling.scan.positions - 1
    covered = np.zeros((int(y.max()) + 1, int(x.max() - x.min()) + 1 + last), bool)
    for position in range(sampling.scan.positions):
        covered[y, x - x.min() + position] = True
    at_x = float(x.min()) - float(x.mean()) - 0.5 * last
    return (covered.shape[1], at_x), (covered.shape[0], -float(y.mean())), covered


def _scattered(sampling: Sampling, residual: Map, shape: tuple[int, ...]) -> Map:
    """Return each frame's residual at its pixels' places."""
    made = np.zeros(shape)
    left = int(_indices(sampling, 0)[0].min())
    for position, frame in zip(sampling.frames, residual, strict=True):
        x, y = _indices(sampling, position)
        made[y, x - left] = frame
    return made
