"""A peak of the spectra of a recording's blocks, and how much of it lines have."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Peak:
    """A peak of the spectrum.

    Attributes:
        cycles_per_line: Its line frequency, -0.5 to 0.5.
        cycles_along: Cycles along a line's (a frame's) pixels, whole ones, to which those per line
            come, for a tone that runs on from pixel to pixel; 0 where all pixels share it.
        squared_amplitude_dn2: Of each block, what the spectrum's floor gives taken off.
        std_dn2: Its standard deviation.
        deviance: By which it stands out; 0 of a place that is looked at for another's sake.
        between: How far from there the tone lies, cycles per line: between two frequencies.
        n_lines: Of which the spectra were taken.
    """

    cycles_per_line: float
    cycles_along: int
    squared_amplitude_dn2: tuple[float, ...]
    std_dn2: tuple[float, ...]
    deviance: float
    between: float = 0.0
    n_lines: int = 1

    @property
    def stands_out(self) -> bool:
        """Whether it was chosen for its height."""
        return self.deviance > 0.0

    def squared_amplitude(self, lines: Floats, between: Floats | None = None) -> float:
        """Return the squared amplitude at this frequency of lines, (n_lines, n_pixels), of mean 0.

        With `between`, (n_lines, k), they are sums of k lines that are given, of these weights.
        """
        n, n_pixels = len(lines if between is None else between), lines.shape[1]
        turns = self.cycles_along + self.cycles_per_line if self.cycles_along else 0.0
        along = np.exp(-2j * np.pi * turns * np.arange(n_pixels) / n_pixels)
        down = np.exp(-2j * np.pi * self.cycles_per_line * np.arange(n))
        # What all pixels of a line have in common has a column of the spectrum of its own.
        own = lines - lines.mean(axis=1, keepdims=True) if self.cycles_along else lines
        shares = down if between is None else down @ between
        power = abs(shares @ (own @ along)) ** 2
        return float(power * (2.0 / (n * n_pixels)) ** 2)

    def share_seen(self, n_lines: int) -> float:
        """Return how much of the tone's squared amplitude `n_lines` lines have at the peak."""
        across = np.sinc(n_lines * self.between) / np.sinc(self.between)
        return float(across**2)

    def frequencies_hz(self, line_period_s: float) -> tuple[float, ...]:
        """Return what may be at work, Hz: a tone of that frequency, or of half of it, or folded."""
        f = self.cycles_per_line + self.between
        if self.cycles_along > 0:
            return ((self.cycles_along + f) / line_period_s,)
        folded = (abs(f), 1.0 - abs(f), 1.0 + abs(f))
        return tuple(x / (k * line_period_s) for x in folded for k in (2.0, 1.0) if x > 0)
