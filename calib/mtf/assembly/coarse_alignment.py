"""A first alignment, good enough to start a fit from: tilt and scale, then every stage position.

Blocks of pixels say where they see the pattern; tilt and scale are how that changes over the
detector. Then each frame is looked for in the pattern's whole cell, so that a stage that went
astray is found.
"""

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from calib.errors import NotDeterminedError
from calib.mtf.assembly.odd_pixels import plausible_pixels
from calib.mtf.assembly.pattern_search import PatternSearch
from calib.mtf.geometry import Alignment
from calib.mtf.grating.harmonics import Harmonics
from calib.mtf.harmonic_sums import Complex, HarmonicSums
from calib.mtf.scan_images import ScanImages

_BLOCK_PIXELS, _MOST_BLOCKS = 24, 8
_PASSES = 2
_LEAST_AGREEMENT = 0.5
_LEAST_STRENGTH = 0.2  # of the other frames' pattern: light may fall so far, noise stays below
_LEAST_LIKENESS = 0.8  # to a square pixel's view; shapes that were tried reach 0.93, chance 0.7
_TRIMMED = 4.0
_LOW = 0.9  # of 1/pitch: up to there a pixel that fills its pitch has not changed its sign


@dataclass(frozen=True, eq=False)
class CoarseAlignment:
    """Where to start.

    Attributes:
        alignment: Its stage errors are those of the scan's frames, in their order.
        without_pattern: Indices of frames that do not show the pattern.
    """

    alignment: Alignment
    without_pattern: tuple[int, ...]


def coarse_alignment(scan: ScanImages) -> CoarseAlignment:
    """Find tilt, scale, shift and each frame's stage error.

    Raises:
        NotDeterminedError: `no-pattern` where most frames do not show the grating's pattern.
    """
    low = _low_harmonics(scan)
    good = plausible_pixels(scan.images)
    images = (scan.images - scan.images[:, good].mean(axis=1)[:, None, None]) * good
    alignment = Alignment()
    for _ in range(_PASSES):
        alignment = _tilt_and_scale(scan, images, low, alignment)
    return _stage_positions(scan, images, low, alignment)


def _low_harmonics(scan: ScanImages) -> Harmonics:
    """Return the harmonics that a pixel of any shape is likely to carry with their own sign."""
    harmonics = scan.grating.harmonics
    low = np.hypot(*harmonics.frequency_per_um.T) < _LOW / scan.scan.pitch_um
    if low.sum() < 2:
        msg = f"the grating has no two harmonics below {_LOW}/pitch, so that its pattern cannot be"
        raise NotDeterminedError(f"{msg} found: take one of longer period", code="no-pattern")
    return Harmonics(harmonics.index[low], harmonics.amplitude[low], harmonics.period_um)


def _nominal(scan: ScanImages, low: Harmonics) -> PatternSearch:
    """Return a search for what a square pixel would see."""
    sums = HarmonicSums(scan.sampling(), low.frequency_per_um)
    along_x, along_y = scan.scan.pitch_um * sums.detector_per_um.T
    return PatternSearch(low, low.amplitude * np.sinc(along_x) * np.sinc(along_y))


def _tilt_and_scale(
    scan: ScanImages, images: NDArray[np.floating], low: Harmonics, before: Alignment
) -> Alignment:
    """Fit a small turn and stretch to the blocks' shifts; leave out blocks that stand apart."""
    sums = HarmonicSums(scan.sampling(before), low.frequency_per_um)
    counts = [min(max(n // _BLOCK_PIXELS, 1), _MOST_BLOCKS) for n in images.shape[1:]]
    spectra, centres = _block_spectra(sums, images, *counts)
    shifts = _nominal(scan, low).best(spectra)
    middle = shifts[np.argmax(np.abs(spectra).sum(1))]
    near = np.array([low.shortest(each - middle) for each in shifts]) @ (1, 1j)
    keep = np.ones(len(near), bool)
    for _ in range(3):
        design = np.stack([np.ones(len(near)), -centres], axis=1)
        fitted = np.linalg.lstsq(design[keep], near[keep], rcond=None)[0]
        away = np.abs(near - design @ fitted)
        keep = away <= _TRIMMED * np.median(away) + 1e-9
    offset, turn = (fitted[0], fitted[1]) if len(near) >= 4 else (near.mean(), 0j)
    shift = before.shift_um + middle + [offset.real, offset.imag]
    grown = (1 + before.scale) * np.exp(1j * before.tilt_rad) * (1 + turn)
    return Alignment(low.shortest(shift), float(np.abs(grown) - 1), float(np.angle(grown)))


def _block_spectra(
    sums: HarmonicSums, images: NDArray[np.floating], n_rows: int, n_columns: int
) -> tuple[Complex, Complex]:
    """Return the spectrum of each block over all frames, and its place about the centre, µm.

    Places are complex numbers x + iy in the grating's frame.
    """
    sampling = sums.sampling
    row_cuts = np.linspace(0, sampling.n_rows, n_rows + 1).astype(int)
    column_cuts = np.linspace(0, sampling.n_columns, n_columns + 1).astype(int)
    n = len(sums.frequency_per_um)
    found = np.zeros((n_rows, n_columns, n), np.complex128)
    across = np.hstack([sums.columns.real.T, -sums.columns.imag.T])
    for image, frame in zip(images, sums.frames, strict=True):
        down = (sums.rows * frame[:, None]).conj().T
        for j, (left, right) in enumerate(pairwise(column_cuts)):
            lines = image[:, left:right] @ across[left:right]
            turned = (lines[:, :n] + 1j * lines[:, n:]) * down
            found[:, j] += np.add.reduceat(turned, row_cuts[:-1], axis=0)
    rows = [sampling.row[a:b].mean() for a, b in pairwise(row_cuts)]
    columns = [sampling.column[a:b].mean() for a, b in pairwise(column_cuts)]
    places = np.add.outer(1j * np.array(rows), np.array(columns)).ravel()
    turn = np.exp(1j * (sampling.scan.tilt_rad + sampling.alignment.tilt_rad))
    return found.reshape(len(places), -1), sampling.scan.pitch_um * turn * places


def _stage_positions(
    scan: ScanImages, images: NDArray[np.floating], low: Harmonics, alignment: Alignment
) -> CoarseAlignment:
    """Look for each frame in what most frames agree on."""
    sums = HarmonicSums(scan.sampling(alignment), low.frequency_per_um)
    spectra = sums.spectra(images) * sums.frames.conj()
    consensus = np.median(spectra.real, axis=0) + 1j * np.median(spectra.imag, axis=0)
    nominal = _nominal(scan, low)
    likeness = nominal.agreement(consensus[None], nominal.best(consensus[None]))[0]
    if likeness < _LEAST_LIKENESS:
        raise _no_pattern()
    search = PatternSearch(low, consensus)
    found = search.best(spectra)
    blind = search.agreement(spectra, found) < _LEAST_AGREEMENT
    blind |= search.strength(spectra, found) < _LEAST_STRENGTH
    if blind.sum() > len(blind) / 2:
        raise _no_pattern()
    errors = np.where(blind[:, None], 0.0, -found)
    return CoarseAlignment(
        replace(alignment, stage_um=errors), tuple(np.flatnonzero(blind).tolist())
    )


def _no_pattern() -> NotDeterminedError:
    msg = "the frames do not show the pattern of this grating: check eta2, period_um, pitch_um, m"
    msg += " and n, and that frames are in the stage's order"
    return NotDeterminedError(msg, code="no-pattern")
