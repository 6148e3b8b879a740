"""What is measured of real frames beside the diagnosis: deferred charge, shared noise, tones."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from examples.real.folders import BLANK, TRAIL, frame_of, taps_of

Floats = NDArray[np.float64]


def dark_pair(files: Path) -> list[Floats]:
    """Return the taps' noise: the difference of two darks over √2, outliers and median taken off.

    (520, 1076) each, in the order of the read-out; two frames' offsets and charges cancel.
    """
    pairs = zip(*(taps_of(frame_of(files, n)) for n in (4860, 4861)), strict=True)
    halves = ((b - a) / np.sqrt(2.0) for a, b in pairs)
    return [np.clip(h - np.median(h), -25.0, 25.0) for h in halves]


def deferred(files: Path) -> list[tuple[float, float]]:
    """Return each tap's charge in the first column behind the last lit one, share and transfers'.

    Extended pixel edge response: share / number of transfers is the charge-transfer inefficiency.
    """
    found = []
    for taps in zip(*(taps_of(frame_of(files, n)) for n in (4803, 4804)), strict=True):
        mean = np.mean(taps, axis=0)[100:500]
        zero = mean[:, 10 : BLANK - 5].mean()
        share = (mean[:, -TRAIL].mean() - zero) / (mean[:, -TRAIL - 1].mean() - zero)
        found.append((float(share), float(share / (mean.shape[1] - TRAIL))))
    return found


def dark_growth(folder: Path) -> list[float]:
    """Return how much lit pixels gain over the tap's blank columns in 10 s more of dark, DN."""
    found = []
    for short, long in zip(
        taps_of(frame_of(folder, 1772)), taps_of(frame_of(folder, 1829)), strict=True
    ):
        over = [
            float(_clipped(t[100:500, 100:1000]).mean() - _clipped(t[100:500, 10:45]).mean())
            for t in (short, long)
        ]
        found.append(over[1] - over[0])
    return found


def _clipped(values: Floats) -> Floats:
    middle = np.median(values)
    return np.clip(values, middle - 20.0, middle + 20.0)


def spectrum(noise: Floats) -> Floats:
    """Return the power of a tap's noise along its read-out, (n // 2 + 1,)."""
    line = noise.ravel()
    return np.asarray(np.abs(np.fft.rfft(line)) ** 2 / len(line))


def lsst_covariances(file: Path) -> Floats:
    """Return Cov(i, j) / mean², 1/e⁻, (9, 9)."""
    rows = np.loadtxt(file, skiprows=1)
    found = np.zeros((9, 9))
    found[rows[:, 0].astype(int), rows[:, 1].astype(int)] = rows[:, 2]
    return found
