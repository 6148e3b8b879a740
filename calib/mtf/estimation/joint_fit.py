"""Direct least squares on the harmonics: all pixels and positions, and the bench's errors, at once.

Gauss-Newton on the amplitudes of all harmonics, scale, tilt, and each frame's position and light;
then generalised least squares with each pixel's gain and offset as random effects, whose variances
are found anew after each step: the plain fit takes a part of them for the pattern's, the more the
fewer pixels there are to an unknown.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from calib.errors import NotDeterminedError
from calib.mtf.assembly.odd_pixels import good_pixels, plausible_pixels
from calib.mtf.estimation.harmonic_fit import HarmonicFit
from calib.mtf.estimation.normal_equations import Normal, normal_matrix
from calib.mtf.estimation.normal_solver import NormalSolver
from calib.mtf.estimation.pixel_effects import PixelEffects, pixel_effects
from calib.mtf.estimation.sandwich import lower_square, sandwich, scores_by_rows, whole
from calib.mtf.estimation.slopes import Slopes
from calib.mtf.estimation.state import State, Unknowns
from calib.mtf.geometry import Alignment
from calib.mtf.harmonic_sums import Frames
from calib.mtf.scan_images import ScanImages

_MOST_STEPS = 12
_SETTLED = 1e-3  # of a standard deviation per unknown
_ASTRAY, _AT_LEAST = 10.0, 0.05  # medians of all frames' errors; of the stage's step


@dataclass(frozen=True, eq=False)
class _At:
    """A state, its residual (odd pixels 0) and the pixels that are not odd."""

    slopes: Slopes
    residual: Frames
    good: NDArray[np.bool_]


def joint_fit(scan: ScanImages, start: Alignment) -> HarmonicFit:
    """Fit all unknowns to all images.

    Args:
        scan: Every frame of it shows the pattern.
        start: Within a tenth of the finest period of the truth, or so.

    Raises:
        NotDeterminedError: `aliased`, or `no-convergence` where the start was too far away.
    """
    plausible = plausible_pixels(scan.images)
    at = _settle(scan, _start(scan, start, plausible), plausible)
    good = plausible & good_pixels(at.residual, at.slopes.model)
    if (good != plausible).any():
        at = _settle(scan, at.slopes.state, good)
    return _generalised(scan, at)


def _start(scan: ScanImages, start: Alignment, good: NDArray[np.bool_]) -> State:
    """Return the state with the mean alone, its stage errors about the mean of steady frames."""
    stage = np.zeros((len(scan.positions), 2)) if start.stage_um is None else start.stage_um
    away = np.abs(stage - np.median(stage, axis=0))
    steady = (away <= _ASTRAY * np.median(away, axis=0) + _AT_LEAST * scan.scan.step_um).all(axis=1)
    middle = stage[steady].mean(axis=0)
    alignment = replace(start, stage_um=stage - middle, shift_um=start.shift_um - middle)
    levels = scan.images[:, good].mean(axis=1)
    amplitude = np.zeros(len(scan.grating.harmonics) + 1, np.complex128)
    amplitude[0] = levels.mean() / 2
    levels /= levels[steady].mean()
    return State(scan.grating.harmonics, scan.sampling(alignment), amplitude, levels, steady)


def _settle(scan: ScanImages, state: State, good: NDArray[np.bool_]) -> _At:
    """Take Gauss-Newton steps until they no longer matter; geometry joins after the first."""
    for number in range(_MOST_STEPS):
        slopes = Slopes(state)
        residual = _residual(scan, slopes, good)
        normal = normal_matrix(state)
        solved = NormalSolver.of(_amplitudes_first(normal, state, first=number == 0), state)
        step = solved.solve(slopes.total(residual))
        if number and _is_settled(step, normal, residual, state):
            return _At(slopes, residual, good)
        if number == 0:
            step[state.layout.scale :] = 0
        state = state.moved(step)
    raise _does_not_settle()


def _amplitudes_first(normal: Normal, state: State, *, first: bool) -> Normal:
    """Return the matrix of the first step, which knows no slope of the geometry yet."""
    if not first:
        return normal
    alone = normal.copy()
    rest = slice(state.layout.scale, None)
    alone[rest, :], alone[:, rest] = 0, 0
    np.fill_diagonal(alone[rest, rest], 1.0)
    return alone


def _residual(scan: ScanImages, slopes: Slopes, good: NDArray[np.bool_]) -> Frames:
    residual = scan.images - slopes.model
    residual[:, ~good] = 0
    return residual


def _generalised(scan: ScanImages, at: _At) -> HarmonicFit:
    """Take generalised steps until they no longer matter, and attach the covariance."""
    for _ in range(_MOST_STEPS):
        model = at.slopes.model
        effects = pixel_effects(at.residual, model, at.good)
        normal, residual = normal_matrix(at.slopes.state), at.residual
        if effects.are_seen:
            normal = normal - _taken_out(at, effects)
            residual = effects.whitened(residual, model)
            residual[:, ~at.good] = 0
        solved = NormalSolver.of(normal, at.slopes.state)
        step = solved.solve(at.slopes.total(residual))
        if not effects.are_seen or _is_settled(step, normal, residual, at.slopes.state):
            covariance = sandwich(at.slopes, residual, normal, solved)
            gain, offset = effects.of(at.residual, model)
            return HarmonicFit(
                at.slopes.state, covariance, residual, effects.noise, gain, offset,
                effects.gain_std, at.good,
            )  # fmt: skip
        slopes = Slopes(at.slopes.state.moved(step))
        at = _At(slopes, _residual(scan, slopes, at.good), at.good)
    raise _does_not_settle()


def _is_settled(step: Unknowns, normal: Normal, residual: Frames, state: State) -> bool:
    variance = (residual**2).mean() + np.finfo(float).eps * state.amplitude[0].real ** 2
    return bool(step @ normal @ step < _SETTLED**2 * variance * len(step))


def _does_not_settle() -> NotDeterminedError:
    msg = "the pattern's position does not settle: check pitch_um, period_um, m and n"
    return NotDeterminedError(msg, code="no-convergence")


def _taken_out(at: _At, effects: PixelEffects) -> Normal:
    """Return Σ over pixels of (slopesᵀ·Z·L)(slopesᵀ·Z·L)ᵀ: what gains and offsets hide."""
    total = np.zeros((at.slopes.state.layout.size,) * 2)
    for direction in effects.directions(at.slopes.model):
        for scores in scores_by_rows(at.slopes, direction * at.good):
            total += lower_square(scores)
    return whole(total)
