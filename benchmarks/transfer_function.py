"""From a grating's scan to the pixel's transfer function: Eq. 6 alone, and the whole of it."""

import os
import resource
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from numpy.typing import NDArray
from scipy import fft

from benchmarks.race import race
from benchmarks.row import Row
from benchmarks.size import Size
from calib.mtf.assembly.coarse_alignment import coarse_alignment
from calib.mtf.assembly.oversampled import Oversampled, oversampled
from calib.mtf.estimation.joint_fit import joint_fit
from calib.mtf.filter.regressive_filter import RegressiveFilter
from calib.mtf.filter.thumbnails import Thumbnails
from calib.mtf.filter.window import Window
from calib.mtf.geometry import Alignment, Scan
from calib.mtf.grating.grating import Grating
from calib.mtf.scan_images import ScanImages
from calib.mtf.simulation.bench import Bench
from calib.mtf.simulation.detector import DetectorNoise
from calib.mtf.simulation.folder import write_folder
from calib.mtf.simulation.shapes import square

ROOT = str(Path(__file__).parents[1])
ROWS, COLUMNS = 256, 320
TO_REACH_S = 10.0
SCAN, GRATING = Scan(25.0, 1, 6), Grating(650, 500.0)


def run(size: Size) -> Row:
    """Filter one oversampled image; pixels are those of all frames. Notes tell the whole."""
    shape = (min(size.n_lines, ROWS), min(size.n_columns, COLUMNS))
    rng = np.random.default_rng(1)
    noise = DetectorNoise(shot_noise=True, gain_std=0.01, averaged=100)
    bench = Bench(SCAN, GRATING, square(25.0, 1.0), shape, Alignment(np.array([7.0, 3.0])), noise)
    scan = ScanImages.whole(SCAN, GRATING, bench.record(rng))
    whole_s = _whole(scan.images, size.folder)
    fit = joint_fit(scan, coarse_alignment(scan).alignment)
    grid = oversampled(fit, fit.state.sampling.alignment.shift_um, select_harmonics=False)
    thumbnails = Thumbnails(Window(3 * SCAN.pitch_um / SCAN.step_um), grid.covered)
    frequency = _frequencies()

    def ours() -> None:
        filtering = RegressiveFilter.of(thumbnails, grid.pattern)
        filtering.transfer(filtering.numerator(grid.image), frequency)

    def with_noise() -> None:
        filtering = RegressiveFilter.of(thumbnails, grid.pattern)
        filtering.transfer(filtering.numerator(grid.image), frequency)
        filtering.noise_gain(frequency)

    cut = np.zeros((thumbnails.count, *(2 * [len(thumbnails.window.values)])))
    work = scan.images.size / 1e6
    figures = race(
        work,
        {
            "ours": ours,
            "with noise": with_noise,
            "numpy": lambda: plain_filter(grid, thumbnails),
            "limit": lambda: [_transformed(cut, thumbnails.padded) for _ in "IO"],
        },
        rounds=min(size.rounds, 5),
    )
    return Row(
        work=f"transfer function by Eq. 6, {shape[1]} x {shape[0]} at {SCAN.positions} positions",
        unit="Mpix/s",
        ours=figures["ours"].rate,
        numpy=figures["numpy"],
        peers={},
        limit=figures["limit"],
        limit_is="the thumbnails' Fourier transforms alone, two threads",
        bound=f"the whole reduction in {TO_REACH_S:.0f} s of processor time",
        reached=whole_s <= TO_REACH_S,
        notes=(
            f"{whole_s:.1f} s of processor time for darkflat mtf, all covariances included",
            f"{work / figures['ours'].rate:.2f} s for Eq. 6, {thumbnails.count} thumbnails, in the"
            f" detector's frame; {work / figures['with noise'].rate:.2f} s with its noise",
        ),
    )


def _whole(images: NDArray[np.floating], folder: Path | None) -> float:
    """Return the processor time of the command from a folder to TF.h5, its start included, s."""
    with TemporaryDirectory(dir=folder) as scratch:
        write_folder(Path(scratch) / "scan", SCAN, GRATING, images)
        command = "from service.cli import main; main()"
        begun = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run(
            [sys.executable, "-c", command, "mtf", "scan", "--out", "TF.h5"],
            cwd=scratch, check=True, capture_output=True, env={**os.environ, "PYTHONPATH": ROOT},
        )  # fmt: skip
        ended = resource.getrusage(resource.RUSAGE_CHILDREN)
        return ended.ru_utime + ended.ru_stime - begun.ru_utime - begun.ru_stime


def plain_filter(grid: Oversampled, thumbnails: Thumbnails) -> NDArray[np.complexfloating]:
    """Return Eq. 6 as it is printed: window by window, two FFTs each, on the FFT's own grid."""
    size = len(thumbnails.window.values)
    shape = np.multiply.outer(thumbnails.window.values, thumbnails.window.values)
    padded = (thumbnails.padded, thumbnails.padded)
    above, below = np.zeros(padded, np.complex128), np.zeros(padded)
    for j, i in np.argwhere(thumbnails.used) * thumbnails.step:
        image, pattern = (
            np.fft.fft2(each[j : j + size, i : i + size] * shape, padded)
            for each in (grid.image, grid.pattern)
        )
        above += image * pattern.conj()
        below += np.abs(pattern) ** 2
    return above / below


def _transformed(cut: NDArray[np.floating], padded: int) -> NDArray[np.complexfloating]:
    lines = fft.rfft(cut, padded, axis=-1, workers=2)
    transformed: NDArray[np.complexfloating] = fft.fft(lines, padded, axis=-2, workers=2)
    return transformed


def _frequencies() -> NDArray[np.floating]:
    """Return the grid of the file that `darkflat mtf` writes, cycles per step: (n, 2)."""
    step = SCAN.step_um / (16 * SCAN.pitch_um)
    n = int(np.ceil(GRATING.max_frequency_per_um * SCAN.step_um / step))
    axis = step * np.arange(-n, n + 1)
    return np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2)
