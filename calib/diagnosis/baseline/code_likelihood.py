"""How likely the counts of single codes are, whatever smooth shape the noise about means has.

Counts scatter by the square root of what is expected. That is off where means, or the noise's
variance, skewness or kurtosis, are off in a block: by derivatives of its histogram (Kendall and
Stuart, The Advanced Theory of Statistics 1, chapter 6), each as large as such errors are. With
their covariance N N^T beside that of counting, 1, whitened counts y and what a cause foretells of
them f part by (y - f) (1 + N N^T)^-1 (y - f): narrow peaks tell what is no error of their shape.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

ERRORS = (0.05, 0.1, 0.3, 0.3)
"""Of a mean over the noise, of a variance relative to it, of skewness, of kurtosis."""
SHARE_ERROR = 0.01
"""Of a single code's share where noise is half a DN or less: it hangs on where means lie in it."""
FEWEST = 1.0
"""Codes of which fewer samples are expected tell nothing."""
WIDTHS = np.geomspace(1e-3, 1.0, 25)
"""Standard deviations of the codes' widths that are tried, DN."""


@dataclass(frozen=True)
class CodeLikelihood:
    """What is expected of single codes, and by how much that may be off.

    Attributes:
        of_blocks: Expected samples by code of each block, (n_codes,).
        noise: Standard deviation of its samples about their means, DN, by block.
    """

    of_blocks: Mapping[int, Floats]
    noise: Mapping[int, float]

    def explained(self, seen: Floats, told: Floats) -> float:
        """Return the deviance of counts off by `seen` that `told` explains, as much as there is.

        Args:
            seen: Observed less expected samples by code, (n_codes,).
            told: By what a cause changes them at some strength, likewise.
        """
        along = max(float(self._whitened(told) @ self._freed(seen)), 0.0)
        return along**2 / max(self.worth(told), 1e-300)

    def worth(self, told: Floats) -> float:
        """Return the deviance between counts that a cause changes so and those without it."""
        return float(self._whitened(told) @ self._freed(told))

    def of_any_widths(self, seen: Floats) -> float:
        """Return the same of codes each of which is off by a normal number of its own.

        Of counts e with widths that scatter by w, y has the variance 1 + e w^2.
        """
        off2, wide = self._freed(seen) ** 2, np.outer(WIDTHS**2, self._expected[self._used])
        return float((off2 * wide / (1.0 + wide) - np.log1p(wide)).sum(axis=1).max())

    def _freed(self, change: Floats) -> Floats:
        """Return whitened changes, those likeliest by errors of means and noise taken out."""
        own, errors = self._whitened(change), self._errors
        if not len(errors):
            return own
        inner = np.eye(len(errors)) + errors @ errors.T
        return np.asarray(own - np.linalg.solve(inner, errors @ own) @ errors)

    def _whitened(self, change: Floats) -> Floats:
        return np.asarray(change[self._used] / self._std)

    @cached_property
    def _expected(self) -> Floats:
        return np.asarray(sum(self.of_blocks.values()))

    @cached_property
    def _used(self) -> NDArray[np.intp]:
        return np.flatnonzero(self._expected > FEWEST)

    @cached_property
    def _std(self) -> Floats:
        variance = self._expected.copy()
        for b, expected in self.of_blocks.items():
            # Means within a code tell a share of two codes' by this part less: Widrow's harmonic.
            told = np.exp(-0.5 * np.pi**2 * max(self.noise[b] ** 2 - 0.25, 0.0))
            variance += (SHARE_ERROR * told * expected) ** 2
        return np.asarray(np.sqrt(variance[self._used]))

    @cached_property
    def _errors(self) -> Floats:
        """What errors of means and noise make of counts, whitened, (n_errors, n_used)."""
        found, factorial = [], (1.0, 2.0, 6.0, 24.0)
        for b, expected in self.of_blocks.items():
            slope, noise = expected, self.noise[b]
            for order, error in enumerate(ERRORS, start=1):
                slope = np.gradient(slope)
                found.append(error * noise**order / factorial[order - 1] * self._whitened(slope))
        return np.array(found)
