"""Inner products of the images' derivatives, in closed form: no pixel is looked at.

With E the harmonics' phases over the detector, the images 2·Re Σ w_h·E_h and 2·Re Σ w'_g·E_g have
the inner product 2·Re(w^H·M⁻·w' + w^T·M⁺·w'), M⁻ = Σ conj(E_h)·E_g and M⁺ = Σ E_h·E_g over all
pixels. Both are products of a sum over rows and one over columns; weights row^i·col^j leave them
so.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from calib.mtf.estimation.state import State
from calib.mtf.harmonic_sums import Complex

Normal = NDArray[np.floating]
Kernels = tuple[Complex, Complex]
KernelsOf = Callable[[int, int], Kernels]
"""M⁻ and M⁺ with the weight row^i·col^j."""


@dataclass(frozen=True, eq=False)
class Term:
    """Images row^i·col^j · 2·Re Σ w·E, w by frame: (n_frames, n + 1)."""

    weight: Complex
    i: int = 0
    j: int = 0


Images = tuple[Term, ...]


def normal_matrix(state: State) -> Normal:
    """Return Σ over pixels and frames of derivative · derivative, for all pairs of unknowns."""
    layout = state.layout
    kernels = _kernels(state)
    found = np.zeros((layout.size, layout.size))
    turned = state.sums.frames * state.level[:, None]
    amplitudes = slice(0, layout.scale)
    found[amplitudes, amplitudes] = _among_amplitudes(turned, kernels(0, 0))
    scale_and_tilt, frames = _geometry(state), _of_frames(state)
    for which, images in enumerate(frames):
        at = layout.of_frames(which)
        found[amplitudes, at] = _with_amplitudes(turned, images, kernels).T
        for other, more in enumerate(frames[: which + 1]):
            np.fill_diagonal(found[layout.of_frames(other), at], _products(more, images, kernels))
    for column, images in zip((layout.scale, layout.tilt), scale_and_tilt, strict=True):
        found[amplitudes, column] = _with_amplitudes(turned, images, kernels).sum(0)
        for which, more in enumerate(frames):
            found[column, layout.of_frames(which)] = _products(images, more, kernels)
        found[layout.scale, column] = _products(scale_and_tilt[0], images, kernels).sum()
        found[layout.tilt, column] = _products(scale_and_tilt[1], images, kernels).sum()
    upper = np.triu(found)
    return upper + np.triu(upper, 1).T


def _kernels(state: State) -> KernelsOf:
    """Return what gives M⁻ and M⁺ with weights row^i·col^j."""
    sums, sampling = state.sums, state.sampling

    @cache
    def kernels(i: int, j: int) -> Kernels:
        rows, columns = sums.rows * sampling.row**i, sums.columns * sampling.column**j
        minus = (sums.rows.conj() @ rows.T) * (sums.columns.conj() @ columns.T)
        plus = (sums.rows @ rows.T) * (sums.columns @ columns.T)
        return minus, plus

    return kernels


def _among_amplitudes(turned: Complex, kernels: Kernels) -> Normal:
    minus = kernels[0] * (turned.conj().T @ turned)
    plus = kernels[1] * (turned.T @ turned)
    real_real, mixed = 2 * (minus + plus).real, -2 * (minus + plus).imag
    imaginary = 2 * (minus - plus).real
    return np.block([[real_real, mixed[:, 1:]], [mixed[:, 1:].T, imaginary[1:, 1:]]])


def _with_amplitudes(turned: Complex, images: Images, kernels: KernelsOf) -> Normal:
    """Return inner products of each frame's image with all amplitudes: (n_frames, 2n + 1)."""
    minus, plus = np.zeros((2, *turned.shape), np.complex128)
    for term in images:
        one, two = kernels(term.i, term.j)
        minus += turned.conj() * (term.weight @ one.T)
        plus += turned * (term.weight @ two.T)
    return np.hstack([2 * (minus + plus).real, 2 * (minus - plus).imag[:, 1:]])


def _products(images: Images, others: Images, kernels: KernelsOf) -> Normal:
    """Return the inner product of two images, frame by frame."""
    total = np.zeros(len(images[0].weight))
    for one in images:
        for two in others:
            minus, plus = kernels(one.i + two.i, one.j + two.j)
            total += 2 * (one.weight.conj() * (two.weight @ minus.T)).sum(1).real
            total += 2 * (one.weight * (two.weight @ plus.T)).sum(1).real
    return total


def _geometry(state: State) -> tuple[Images, Images]:
    """Return the images' derivatives by scale and by tilt.

    By scale: (col·∂/∂col + row·∂/∂row)/(1 + scale); by tilt: col·∂/∂row − row·∂/∂col.
    """
    turn = 2j * np.pi * state.sampling.scan.pitch_um * state.sums.detector_per_um
    by_column, by_row = state.by_frame * turn[:, 0], state.by_frame * turn[:, 1]
    size = 1 + state.sampling.alignment.scale
    scale = (Term(np.asarray(by_column / size), 0, 1), Term(np.asarray(by_row / size), 1, 0))
    return scale, (Term(by_row, 0, 1), Term(-by_column, 1, 0))


def _of_frames(state: State) -> tuple[Images, Images, Images]:
    """Return the images' derivatives by x, y and level of their frame."""
    turn = 2j * np.pi * state.sums.frequency_per_um
    by_x, by_y = state.by_frame * turn[:, 0], state.by_frame * turn[:, 1]
    return (Term(by_x),), (Term(by_y),), (Term(state.sums.frames * state.amplitude),)
